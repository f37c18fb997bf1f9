// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Inputs that contradict each other, with the real command: one error line that names the input and
// the factor; exit code 1; no output. And no warning where they agree.
#include <algorithm>
#include <functional>
#include <sstream>

#include <gtest/gtest.h>

#include "pcavr/perception/marker/body_pose.hpp"
#include "pcavr/recordings/recording/frame_reader.hpp"
#include "pcavr/recordings/recording/recording_writer.hpp"
#include "pcavr/simulation/simulate.hpp"

#include "support/json_command.hpp"
#include "support/shared_data.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// 1.5 s of a table with a base tag and a tagged box, simulated once; each test changes a copy.
class ContradictingInputs : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    SimulationCase simulation = simulation_cases().front();
    simulation.duration = 1.5;
    simulation.frame_rate = 8.0;
    simulation.clutter = 3;
    fs::create_directories(sound());
    ASSERT_TRUE(simulate(simulation, 11, sound(), Parallelism::max()));
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  void SetUp() override {
    fs::remove_all(recording());
    fs::copy(sound(), recording(), fs::copy_options::recursive);
  }

  static fs::path sound() { return folder_->path() / "sound"; }
  static fs::path recording() { return folder_->path() / "recording"; }
  static fs::path scene() { return folder_->path() / "scene"; }

  static void replace(const std::string& name, const std::string& from, const std::string& to) {
    std::string text = read_file(recording() / name).value();
    const std::size_t at = text.find(from);
    ASSERT_NE(at, text.npos) << text;
    ASSERT_TRUE(write_file(recording() / name, text.replace(at, from.size(), to)));
  }

  /// The true camera poses as groundtruth.txt, each row's seven numbers changed.
  static void give_poses(const std::function<void(std::vector<double>&)>& change) {
    std::istringstream lines(read_file(recording() / "truth/camera.txt").value());
    std::ostringstream out;
    out.precision(12);
    for (std::string line; std::getline(lines, line);) {
      if (line.empty() || line[0] == '#') continue;
      std::istringstream row(line);
      std::string stamp;
      row >> stamp;
      std::vector<double> numbers(7);
      for (double& number : numbers) row >> number;
      change(numbers);
      out << stamp;
      for (const double number : numbers) out << ' ' << number;
      out << '\n';
    }
    ASSERT_TRUE(write_file(recording() / "groundtruth.txt", out.str()));
  }

  static void scale_mesh(double factor) {
    std::istringstream lines(read_file(recording() / "objects/box.obj").value());
    std::ostringstream out;
    for (std::string line; std::getline(lines, line);) {
      double x = 0.0, y = 0.0, z = 0.0;
      if (std::sscanf(line.c_str(), "v %lf %lf %lf", &x, &y, &z) == 3) {
        out << "v " << factor * x << ' ' << factor * y << ' ' << factor * z << '\n';
      } else {
        out << line << '\n';
      }
    }
    ASSERT_TRUE(write_file(recording() / "objects/box.obj", out.str()));
  }

  /// Build fails with one line that contains each of `texts` and writes nothing; inspect reports
  /// BAD.
  static void expect_refused(const std::vector<std::string>& texts, bool inspects = true) {
    const CommandOutcome outcome =
        run_pcavr({"build", recording().string(), "-o", scene().string(), "--voxel", "0.02"});
    EXPECT_EQ(outcome.exit_code, 1) << outcome.standard_error;
    EXPECT_EQ(outcome.standard_output, "");
    EXPECT_FALSE(fs::exists(scene()));
    const std::size_t at = outcome.standard_error.find("pcavr: ");
    ASSERT_NE(at, std::string::npos) << outcome.standard_error;
    const std::string line = outcome.standard_error.substr(at);
    EXPECT_EQ(std::count(line.begin(), line.end(), '\n'), 1) << line;
    for (const std::string& text : texts) {
      EXPECT_NE(line.find(text), std::string::npos) << "no '" << text << "' in: " << line;
    }
    if (!inspects) return;
    const CommandOutcome inspected = run_pcavr({"inspect", recording().string()});
    EXPECT_EQ(inspected.exit_code, 1) << inspected.standard_output;
    EXPECT_NE(inspected.standard_output.find("BAD"), std::string::npos)
        << inspected.standard_output << inspected.standard_error;
  }

  static TemporaryFolder* folder_;
};
TemporaryFolder* ContradictingInputs::folder_ = nullptr;

TEST_F(ContradictingInputs, AreNotFoundInASoundRecording) {
  give_poses([](std::vector<double>&) {});
  const json built =
      run_json({"build", recording().string(), "-o", scene().string(), "--voxel", "0.02"});
  EXPECT_TRUE(built["input_warnings"].empty()) << built["input_warnings"];
  const json inspected = run_json({"inspect", recording().string()});
  EXPECT_TRUE(inspected["is_sound"].get<bool>());
  EXPECT_EQ(inspected["checks"].back()["what"], "consistency");
  fs::remove_all(scene());
}

TEST_F(ContradictingInputs, DoctorStatesWhatAgreesAndWhatCouldNotBeChecked) {
  const json report = run_json({"doctor", recording().string()});
  EXPECT_TRUE(report["disagrees"].empty()) << report["disagrees"];
  const std::string agreeing = report["agrees"].dump();
  EXPECT_NE(agreeing.find("\"tag tag36h11:0\""), agreeing.npos) << agreeing;
  EXPECT_NE(agreeing.find("sampled frames"), agreeing.npos) << agreeing;
  EXPECT_NE(agreeing.find("of the pixels are measured"), agreeing.npos) << agreeing;
  EXPECT_FALSE(report["not_checked"].empty());
  EXPECT_TRUE(report["next"].get<std::string>().starts_with("pcavr build")) << report["next"];
}

TEST_F(ContradictingInputs, DoctorNamesAWrongSizeWithItsFactor) {
  replace("recording.yaml", "size: 0.12", "size: 0.06");
  const CommandOutcome outcome = run_pcavr({"doctor", recording().string()});
  EXPECT_EQ(outcome.exit_code, 3) << outcome.standard_error;
  const std::string& text = outcome.standard_output;
  const std::size_t disagrees = text.find("disagrees:"), open = text.find("could not be checked:");
  const std::size_t size = text.find("markers[0].size"), factor = text.find("factor 2.0");
  ASSERT_NE(open, text.npos) << text;
  EXPECT_TRUE(disagrees < size && size < factor && factor < open) << text;
}

TEST_F(ContradictingInputs, BaseTagOfHalfItsSize) {
  replace("recording.yaml", "size: 0.12", "size: 0.06");
  expect_refused({"recording.yaml: markers[0].size", "0.06 m", "0.12 m", "factor 2.0"});
}

TEST_F(ContradictingInputs, BaseTagInMillimetres) {
  replace("recording.yaml", "size: 0.12", "size: 120");
  // Out of the range of tag sizes: rejected before the images are read.
  expect_refused({"markers[0].size", "120", "10 m"}, false);
}

TEST_F(ContradictingInputs, DepthScaleOfAnotherSensor) {
  replace("recording.yaml", "depth_scale: 5000", "depth_scale: 1000");
  expect_refused({"camera.depth_scale: 1000 units", "factor 5"});
}

TEST_F(ContradictingInputs, DepthScaleFiveTimesTooLarge) {
  replace("recording.yaml", "depth_scale: 5000", "depth_scale: 25000");
  expect_refused({"camera.depth_scale: 25000 units", "factor 5"});
}

TEST_F(ContradictingInputs, MeshInMillimetres) {
  scale_mesh(1000.0);
  expect_refused({"objects[0].mesh", "box.obj", "scaled by 0.001"});
}

TEST_F(ContradictingInputs, MeshOfTwiceItsSize) {
  scale_mesh(2.0);
  expect_refused({"objects[0].mesh", "box.obj", "scaled by 0.5", "factor 2"});
}

TEST_F(ContradictingInputs, MeshOfTwiceItsSizeWithPosesThatAreTrusted) {
  scale_mesh(2.0);
  give_poses([](std::vector<double>&) {});
  const CommandOutcome outcome = run_pcavr(
      {"build", recording().string(), "-o", scene().string(), "--voxel", "0.02", "--trust-poses"});
  EXPECT_EQ(outcome.exit_code, 1) << outcome.standard_error;
  EXPECT_NE(outcome.standard_error.find("scaled by 0.5"), std::string::npos)
      << outcome.standard_error;
}

TEST_F(ContradictingInputs, FxHalved) {
  replace("recording.yaml", "fx: 525", "fx: 262.5");
  expect_refused({"camera.fx: 262.5 px", "factor 2.0"});
}

TEST_F(ContradictingInputs, FxAndFyHalved) {
  replace("recording.yaml", "fx: 525", "fx: 262.5");
  replace("recording.yaml", "fy: 525", "fy: 262.5");
  expect_refused({"camera.fx, camera.fy: 262.5 and 262.5 px", "factor 2.0"});
}

TEST_F(ContradictingInputs, PosesAMetreOff) {
  give_poses([](std::vector<double>& row) { row[0] += 1.0; });
  expect_refused({"groundtruth.txt", "1 m from where recording.yaml puts them"});
}

TEST_F(ContradictingInputs, PosesInMillimetres) {
  give_poses([](std::vector<double>& row) {
    for (int i = 0; i < 3; ++i) row[static_cast<std::size_t>(i)] *= 1000.0;
  });
  expect_refused({"groundtruth.txt", "metres"});
}

TEST_F(ContradictingInputs, QuaternionsThatBeginWithW) {
  give_poses(
      [](std::vector<double>& row) { std::rotate(row.begin() + 3, row.begin() + 6, row.end()); });
  expect_refused({"groundtruth.txt", "qw qx qy qz"});
}

TEST_F(ContradictingInputs, CauseAWarningBelowTheContradictionFactor) {
  replace("recording.yaml", "size: 0.12", "size: 0.14");
  const json built =
      run_json({"build", recording().string(), "-o", scene().string(), "--voxel", "0.02"});
  // Depth contradicts the size so far that the camera takes the tag's other planar solution: the
  // scene is tilted, which is said, too.
  ASSERT_EQ(built["input_warnings"].size(), 2U) << built["input_warnings"];
  EXPECT_EQ(built["input_warnings"][0]["input"], "markers[0].size");
  EXPECT_EQ(built["input_warnings"][1]["input"], "markers[0].pose");
  EXPECT_NEAR(built["input_warnings"][0]["factor"].get<double>(), 0.14 / 0.12, 0.02);
  EXPECT_NE(read_file(scene() / "scene.yaml").value().find("input_warnings"), std::string::npos);
  EXPECT_TRUE(run_json({"inspect", scene().string()})["is_sound"].get<bool>());

  // replay repeats it: the warning is about the recording.
  const CommandOutcome replayed =
      run_pcavr({"replay", recording().string(), "--scene", scene().string(), "-o",
                 (folder_->path() / "run").string()});
  EXPECT_EQ(replayed.exit_code, 0) << replayed.standard_error;
  EXPECT_NE(replayed.standard_error.find("warning: markers[0].size"), std::string::npos)
      << replayed.standard_error;
  fs::remove_all(scene());
}

TEST_F(ContradictingInputs, ALightOrHugeBodyIsReportedByInspect) {
  replace("recording.yaml", "mass: ", "mass: 0.0001 # ");
  const CommandOutcome inspected = run_pcavr({"inspect", recording().string()});
  EXPECT_EQ(inspected.exit_code, 0) << inspected.standard_output;
  EXPECT_NE(inspected.standard_output.find("objects[0].mass: warning"), std::string::npos)
      << inspected.standard_output;
}

// ---- A scene without a surface: a bare wall, poses given.

class EmptyScene : public testing::Test {
 protected:
  /// Frames of a wall at `z` [m]; the camera moves `step` [m] sideways from frame to frame.
  void write_wall(int frames, float z, double step = 0.01, double depth_scale = 1000.0) {
    fs::create_directories(recording());
    Manifest manifest;
    manifest.camera =
        CameraModel{.width = 160, .height = 120, .fx = 130.0, .fy = 130.0, .cx = 79.5, .cy = 59.5};
    manifest.depth_scale = depth_scale;
    RecordingWriter writer(recording(), manifest);
    Trajectory camera;
    for (int i = 0; i < frames; ++i) {
      const Stamp stamp{i * 50'000'000LL};
      ASSERT_TRUE(writer.add_frame(stamp, ColorImage(160, 120, {90, 90, 90}), stamp,
                                   DepthImage(160, 120, z)));
      camera.append(stamp, Pose::from_translation({step * i, 0.0, 0.0}));
    }
    ASSERT_TRUE(writer.write_groundtruth(camera));
    ASSERT_TRUE(writer.finish());
  }

  void expect_refused(const std::vector<std::string>& texts, bool trusts_poses = true) const {
    const CommandOutcome outcome =
        run_pcavr({"build", recording().string(), "-o", (folder_.path() / "scene").string(),
                   trusts_poses ? "--trust-poses" : "--skip-bad"});
    EXPECT_EQ(outcome.exit_code, 1) << outcome.standard_output;
    EXPECT_FALSE(fs::exists(folder_.path() / "scene"));
    for (const std::string& text : texts) {
      EXPECT_NE(outcome.standard_error.find(text), std::string::npos)
          << "no '" << text << "' in: " << outcome.standard_error;
    }
  }
  [[nodiscard]] fs::path recording() const { return folder_.path() / "recording"; }

  TemporaryFolder folder_;
};

TEST_F(EmptyScene, BecauseAllDepthIsOutOfRange) {
  write_wall(6, 0.12F);
  expect_refused({"yield no surface", "median depth is 0.12 m", "0.0 %", "depth_scale (1000"});
}

TEST_F(EmptyScene, NamesTheDepthWhereNoFrameCouldBeTracked) {
  write_wall(6, 0.12F);
  expect_refused({"no frame could be placed", "median depth is 0.12 m", "depth_scale"}, false);
}

TEST_F(EmptyScene, BecauseOnlyOneFrameIsThere) {
  write_wall(1, 1.0F);
  expect_refused({"yield no surface", "1 of 1 frames"});
}

TEST_F(EmptyScene, BecauseThePosesAreScattered) {
  write_wall(6, 1.0F, 20.0);
  expect_refused({"yield no surface", "scattered", "20 m"});
}

// ---- No false alarm.

/// Expects no warning about an input from build and inspect.
void expect_no_warning(const std::string& recording, const std::vector<std::string>& options = {}) {
  const TemporaryFolder folder;
  const json inspected = run_json({"inspect", recording});
  ASSERT_TRUE(inspected.contains("checks"));
  EXPECT_EQ(inspected["checks"].back()["what"], "consistency") << inspected["checks"].back();
  std::vector<std::string> arguments{"build",   recording, "-o", (folder.path() / "scene").string(),
                                     "--voxel", "0.02"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const json built = run_json(arguments);
  ASSERT_TRUE(built.contains("input_warnings"));
  EXPECT_TRUE(built["input_warnings"].empty()) << built["input_warnings"];
}

TEST(NoFalseAlarm, OnAHandHeldCameraOverATable) {
  PCAVR_NEEDS_SHARED_DATA("tabletop");
  expect_no_warning(shared_data("tabletop").string());
}

TEST(NoFalseAlarm, OnPushedBoxes) {
  PCAVR_NEEDS_SHARED_DATA("push_two_boxes");
  expect_no_warning(shared_data("push_two_boxes").string());
}

TEST(NoFalseAlarm, OnARealSensorsFramesAndPoses) {
  PCAVR_NEEDS_SHARED_DATA("real/seven_scenes");
  const TemporaryFolder folder;
  const std::string recording = (folder.path() / "recording").string();
  run_json({"import", shared_data("real/seven_scenes").string(), "-o", recording});
  expect_no_warning(recording);
}

/// Reads a 4x4 matrix from a text file.
Pose pose_in(const fs::path& file) {
  std::istringstream numbers(read_file(file).value());
  Eigen::Matrix4d matrix;
  for (int i = 0; i < 16; ++i) numbers >> matrix(i / 4, i % 4);
  return Pose::from_matrix(matrix);
}

/// Six views of a board of twelve tags by an arm's camera, with the arm's commanded poses, which
/// have errors up to 15 mm and 2 degrees. The board's pose is that of the first view.
void write_arm_views(const fs::path& folder) {
  const fs::path source = shared_data("real/franka_charuco");
  Manifest manifest;
  manifest.camera = CameraModel{.width = 1920,
                                .height = 1080,
                                .fx = 1363.7733154296875,
                                .fy = 1361.5714111328125,
                                .cx = 956.2984619140625,
                                .cy = 546.5812377929688};
  manifest.depth_scale = 1000.0;
  for (int square = 0; square < 25; ++square) {
    if (square % 2 == 0) continue;
    const Pose tag_pose = Pose::from_translation({0.08 * (square % 5), -0.08 * (square / 5), 0.0});
    manifest.markers.push_back({.id = {"DICT_6X6_250", static_cast<int>(manifest.markers.size())},
                                .size = 0.06,
                                .role = MarkerRole::base,
                                .object = {},
                                .T_parent_marker = tag_pose});
  }
  RecordingWriter writer(folder, manifest);
  const Pose T_flange_camera = pose_in(source / "T_flange_camera_origin_TSAI.txt");
  std::vector<Pose> T_arm_camera;
  for (const char* view : {"01", "08", "15", "22", "29", "36"}) {
    const Stamp stamp = Stamp::from_seconds(0.1 * static_cast<double>(T_arm_camera.size()));
    ASSERT_TRUE(writer.add_frame_files(stamp, source / ("color_" + std::string(view) + ".png"),
                                       stamp, source / ("depth_" + std::string(view) + ".png")));
    T_arm_camera.push_back(
        pose_in(source / ("T_base_flange_commanded_" + std::string(view) + ".txt")) *
        T_flange_camera);
  }
  ASSERT_TRUE(writer.finish());
  const Expected<RgbdFrame> first = decode_frame(read_recording(folder).value(), 0);
  ASSERT_TRUE(first);
  TagDetector detector = TagDetector::create({"DICT_6X6_250"}).value();
  const BodyPose board = solve_body_pose(base_placements(manifest),
                                         detector.detect(to_gray(first->color)), *manifest.camera);
  ASSERT_EQ(board.status, BodyPoseStatus::solved);
  const Pose T_arm_board = T_arm_camera[0] * board.pose.T_camera_body;
  Trajectory camera;
  for (std::size_t i = 0; i < T_arm_camera.size(); ++i) {
    camera.append(Stamp::from_seconds(0.1 * static_cast<double>(i)),
                  T_arm_board.inverse() * T_arm_camera[i]);
  }
  ASSERT_TRUE(write_file(folder / "groundtruth.txt", format_trajectory(camera)));
}

TEST(NoFalseAlarm, OnAnArmsCommandedPoses) {
  PCAVR_NEEDS_SHARED_DATA("real/franka_charuco");
  const TemporaryFolder folder;
  const fs::path recording = folder.path() / "recording";
  fs::create_directories(recording);
  write_arm_views(recording);
  if (HasFatalFailure()) return;
  expect_no_warning(recording.string());
}

}  // namespace
}  // namespace pcavr
