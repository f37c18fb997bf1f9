// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Recordings whose poses come from colour alone, or from elsewhere, with the real command.
#include <regex>

#include <gtest/gtest.h>

#include "pcavr/recordings/recording/recording.hpp"

#include "support/json_command.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// A push of a tagged box in front of a fixed camera, simulated once; each test changes a copy.
class ColourAlone : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    run_json({"simulate", "push", "--duration", "4", "--objects", "1", "--frames-per-second", "10",
              "--seed", "12", "--threads", "2", "-o", path_of("simulated")});
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  void SetUp() override {
    fs::remove_all(path_of("recording"));
    fs::copy(path_of("simulated"), path_of("recording"), fs::copy_options::recursive);
    remove({"depth.txt", "depth", "written.yaml"});
  }

  static std::string path_of(const std::string& name) { return (folder_->path() / name).string(); }
  static void remove(const std::vector<std::string>& names) {
    for (const std::string& name : names) fs::remove_all(fs::path(path_of("recording")) / name);
  }
  static json build() {
    return run_json({"build", path_of("recording"), "-o", path_of("scene"), "--force"});
  }
  /// The errors of the tracked poses.
  static json replay() {
    run_json({"replay", path_of("recording"), "--scene", path_of("scene"), "-o", path_of("run"),
              "--force"});
    return run_json({"evaluate", path_of("run"), "--truth", path_of("recording/truth"), "-o",
                     path_of("report"), "--force"});
  }

  static inline TemporaryFolder* folder_ = nullptr;
};

TEST_F(ColourAlone, TagsPlaceCameraAndObjects) {
  const json scene = build();
  EXPECT_TRUE(scene["is_fixed_camera"]);
  ASSERT_EQ(scene["objects"].size(), 1U);
  EXPECT_EQ(scene["objects"][0]["evidence"], "tags");
  // There is no surface that frames could lie beside.
  EXPECT_TRUE(scene["surface_distance_median_m"].is_null());
  EXPECT_EQ(scene["mesh_triangles"], 0);
  const json errors = replay();
  expect_within(errors, "object.box_1.tracked.absolute.translation.median_m", 0.001);
  expect_within(errors, "object.box_1.tracked.moving.translation.median_m", 0.0015);
  expect_within(errors, "object.box_1.tracked.absolute.rotation.median_rad", 0.005);
}

TEST_F(ColourAlone, PlacesObjectsByGivenCameraPoses) {
  fs::copy_file(path_of("recording/truth/camera.txt"), path_of("recording/groundtruth.txt"));
  build();
  expect_within(replay(), "object.box_1.tracked.absolute.translation.median_m", 0.002);
}

TEST_F(ColourAlone, AllFramesCountAsUsed) {
  const CommandOutcome built =
      run_pcavr({"build", path_of("recording"), "-o", path_of("scene"), "--force"});
  EXPECT_NE(built.standard_output.find("frames     40 of 40 used"), std::string::npos)
      << built.standard_output;
  const CommandOutcome inspected = run_pcavr({"inspect", path_of("scene")});
  EXPECT_EQ(inspected.exit_code, 0) << inspected.standard_output;
  for (const char* text : {"40 frames without depth", "no frame is part of the scene"}) {
    EXPECT_NE(inspected.standard_output.find(text), std::string::npos) << inspected.standard_output;
  }
}

TEST_F(ColourAlone, InspectSaysSo) {
  const CommandOutcome outcome = run_pcavr({"inspect", path_of("recording")});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.standard_error;
  EXPECT_NE(outcome.standard_output.find("no depth.txt"), std::string::npos)
      << outcome.standard_output;
  EXPECT_EQ(outcome.standard_output.find("readings"), std::string::npos);
}

/// A recording of a tracker: no images, and its manifest states no poses.
class TrackedElsewhere : public testing::Test {
 protected:
  void SetUp() override {
    run_json({"simulate", "push", "--no-images", "--duration", "2", "--objects", "2", "--seed",
              "12", "-o", path_of("recording")});
    fs::remove(path_of("recording/written.yaml"));
    const std::string manifest = path_of("recording/recording.yaml");
    std::string text = read_file(manifest).value();
    text = std::regex_replace(text, std::regex("\n *pose: [^\n]*"), "");
    ASSERT_TRUE(write_file(manifest, text));
  }
  [[nodiscard]] std::string path_of(const std::string& name) const {
    return (folder_.path() / name).string();
  }

 private:
  TemporaryFolder folder_;
};

TEST_F(TrackedElsewhere, ObjectsStartAtTheirFirstTrackedPose) {
  // The tracker sees the body only after it was put down.
  const std::string late = path_of("recording/tracked/objects/box_2/tracked.txt");
  ASSERT_TRUE(write_file(late, "1.5 0.61 0.27 0.071 0 0 0.6 0.8\n1.9 0.9 0.9 0.071 0 0 0 1\n"));
  const json scene = run_json({"build", path_of("recording"), "-o", path_of("scene")});
  ASSERT_EQ(scene["objects"].size(), 2U);
  const json& seen_late = scene["objects"][1];
  EXPECT_EQ(seen_late["t_m"], json({0.61, 0.27, 0.071}));
  EXPECT_NEAR(seen_late["q_xyzw"][2].get<double>(), 0.6, 1e-9);
  const Trajectory first =
      read_trajectory(path_of("recording/tracked/objects/box_1/tracked.txt")).value();
  const Eigen::Vector3d start = first.poses().front().pose.translation();
  EXPECT_EQ(scene["objects"][0]["t_m"], json({start.x(), start.y(), start.z()}));
}

TEST_F(TrackedElsewhere, AnObjectThatIsNowhereIsNamed) {
  fs::remove_all(path_of("recording/tracked/objects/box_2"));
  const CommandOutcome outcome = run_pcavr({"build", path_of("recording"), "-o", path_of("scene")});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.standard_error.find("no pose is stated for object box_2"), std::string::npos)
      << outcome.standard_error;
  EXPECT_FALSE(fs::exists(path_of("scene")));
}

/// Images, poses, and no manifest, as in TUM RGB-D.
class ImportedDepth : public ColourAlone {
 protected:
  void SetUp() override {
    ColourAlone::SetUp();
    for (const char* name : {"depth.txt", "depth"}) {
      fs::copy(fs::path(path_of("simulated")) / name, fs::path(path_of("recording")) / name,
               fs::copy_options::recursive);
    }
    // Poses and forces would be taken for the CSV files of a run.
    remove({"recording.yaml", "tool.csv", "wrench.csv"});
  }
  static CommandOutcome import_with(const std::string& depth_scale) {
    const std::string camera = path_of("camera.yaml");
    EXPECT_TRUE(write_file(camera,
                           "name: test\n"
                           "camera: {width: 640, height: 480, fx: 525, fy: 525, cx: 319.5, cy: "
                           "239.5}\n" +
                               depth_scale));
    return run_pcavr(
        {"import", path_of("recording"), "--camera", camera, "-o", path_of("imported"), "--force"});
  }
  static double imported_scale() {
    return read_recording(path_of("imported")).value().manifest.depth_scale;
  }
};

TEST_F(ImportedDepth, HasTheCameraFilesScale) {
  const CommandOutcome outcome = import_with("depth_scale: 500\n");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.standard_error;
  EXPECT_EQ(imported_scale(), 500.0);
  EXPECT_NE(outcome.standard_error.find("--depth-scale 5000"), std::string::npos)
      << outcome.standard_error;
}

TEST_F(ImportedDepth, HasTheUsualScaleWhereTheCameraFileHasNone) {
  const CommandOutcome outcome = import_with("");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.standard_error;
  EXPECT_EQ(imported_scale(), 5000.0);
  EXPECT_EQ(outcome.standard_error.find("depth_scale"), std::string::npos);
}

TEST_F(ImportedDepth, HasTheFormatsScaleWhereTheSensorCanNotReachAsFar) {
  const CommandOutcome outcome = import_with(
      "depth_scale: 1000\ndepth_noise: {constant: 0.0012, quadratic: 0.0019, offset: 0.4, "
      "grazing: 0.0001, nearest: 0.4, farthest: 4.0}\n");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.standard_error;
  EXPECT_EQ(imported_scale(), 5000.0);
  for (const char* text : {"depth_scale 5000 is used", "camera's range", "--depth-scale 1000"}) {
    EXPECT_NE(outcome.standard_error.find(text), std::string::npos) << outcome.standard_error;
  }
}

TEST_F(ImportedDepth, InspectStatesItsRange) {
  ASSERT_EQ(import_with("").exit_code, 0);
  const CommandOutcome outcome = run_pcavr({"inspect", path_of("imported")});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.standard_error;
  for (const char* text : {"nearest ", "median ", "farthest "}) {
    EXPECT_NE(outcome.standard_output.find(text), std::string::npos) << outcome.standard_output;
  }
}

}  // namespace
}  // namespace pcavr
