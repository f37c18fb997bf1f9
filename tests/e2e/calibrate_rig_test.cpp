// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// calibrate camera, depth, tags, force, touch and objects through the real command, on twins that
// are drawn or written here.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "pcavr/base/core/gravity.hpp"
#include "pcavr/perception/marker/body_pose.hpp"
#include "pcavr/recordings/recording/camera_file.hpp"
#include "pcavr/recordings/recording/recording.hpp"
#include "pcavr/recordings/recording/recording_writer.hpp"

#include "board/drawn_board.hpp"
#include "calibration/random_rig.hpp"
#include "support/json_command.hpp"
#include "support/meshes.hpp"
#include "support/shared_data.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

const CameraModel kSmallCamera{
    .width = 320, .height = 240, .fx = 290.0, .fy = 288.0, .cx = 161.0, .cy = 118.0};

class CalibrateRig : public ::testing::Test {
 protected:
  [[nodiscard]] std::string file(const std::string& name) const {
    return (folder_.path() / name).string();
  }
  void write(const std::string& name, const std::string& text) const {
    ASSERT_TRUE(write_file(file(name), text));
  }
  /// "calibrate WHAT INPUT... -o out.yaml" and more.
  [[nodiscard]] std::vector<std::string> command(const std::vector<std::string>& what) const {
    std::vector<std::string> arguments{"calibrate"};
    arguments.insert(arguments.end(), what.begin(), what.end());
    arguments.insert(arguments.end(), {"-o", file("out.yaml"), "--force"});
    return arguments;
  }
  /// The result of a command with a report.
  [[nodiscard]] nlohmann::json found(std::vector<std::string> what) const {
    what.insert(what.end(), {"--report", file("report")});
    const nlohmann::json json = run_json(command(what));
    EXPECT_TRUE(std::filesystem::exists(file("report") + "/report.json"));
    return json;
  }
  /// The one line of a command that fails and leaves no file.
  [[nodiscard]] std::string failure(const std::vector<std::string>& what) const {
    std::filesystem::remove(file("out.yaml"));
    const CommandOutcome outcome = run_pcavr(command(what));
    EXPECT_EQ(outcome.exit_code, 1) << outcome.standard_output;
    EXPECT_FALSE(std::filesystem::exists(file("out.yaml")));
    // Notes and progress are before it.
    const std::size_t begin = outcome.standard_error.rfind("pcavr: ");
    EXPECT_NE(begin, std::string::npos) << outcome.standard_error;
    if (begin == std::string::npos) return outcome.standard_error;
    const std::string line = outcome.standard_error.substr(begin);
    EXPECT_EQ(std::count(line.begin(), line.end(), '\n'), 1) << line;
    return line;
  }
  static void expect_in(const std::string& part, const std::string& text) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  }

  TemporaryFolder folder_;
};

// Camera ---------------------------------------------------------------------------------------

class CalibrateDrawnCamera : public CalibrateRig {
 protected:
  static constexpr char kBoardText[] = "chessboard:7x5:30mm";
  void draw() const {
    const Board board = read_board(kBoardText).value();
    const BoardPaint paint(board);
    std::filesystem::create_directory(file("pictures"));
    int number = 0;
    for (const auto& [x, y] : std::vector<std::pair<double, double>>{
             {0.5, 0.0}, {-0.5, 0.1}, {0.1, 0.6}, {-0.1, -0.6}, {0.4, 0.4}, {-0.4, 0.4}}) {
      const Pose T_camera_board = looking_at(board, 0.32 + 0.02 * number, x, y, 0.2 * y);
      write_picture(folder_.path() / "pictures" / picture_name(number++),
                    draw_board(paint, kSmallCamera, T_camera_board));
    }
  }
};

TEST_F(CalibrateDrawnCamera, FindsItsIntrinsicsAndWritesThemForOthers) {
  draw();
  const nlohmann::json json = found({"camera", file("pictures"), "--board", kBoardText});
  const nlohmann::json& camera = json["intrinsics"];
  EXPECT_NEAR(camera["fx"].get<double>(), kSmallCamera.fx, 2.0);
  EXPECT_NEAR(camera["cy"].get<double>(), kSmallCamera.cy, 2.0);
  const Expected<CameraFile> own = read_camera_file(file("out.yaml"));
  ASSERT_TRUE(own) << own.error().to_string();
  ASSERT_EQ(run_pcavr(command({"camera", file("pictures"), "--board", kBoardText, "--to", "ros"}))
                .exit_code,
            0);
  const Expected<CameraFile> ros = read_camera_file(file("out.yaml"));
  ASSERT_TRUE(ros) << ros.error().to_string();
  EXPECT_EQ(ros->camera, own->camera);
}

TEST_F(CalibrateDrawnCamera, NamesWhatIsWrongWithThePictures) {
  draw();
  expect_in("inner corners",
            failure({"camera", file("pictures"), "--board", "chessboard:8x6:30mm"}));
  expect_in("absent", failure({"camera", file("absent"), "--board", kBoardText}));
}

TEST_F(CalibrateRig, ViewsOfARealRigAgreeWithin4MillimetresByTheirDepth) {
  PCAVR_NEEDS_SHARED_DATA("real/franka_charuco");
  const std::filesystem::path rig = shared_data("real/franka_charuco");
  write("camera.yaml",
        "camera: {width: 1920, height: 1080, fx: 1363.7733, fy: 1361.5714, cx: 956.2985,\n"
        "  cy: 546.5812}\n");
  const nlohmann::json json =
      run_json(command({"hand-eye", (rig / "T_base_flange_commanded").string(),
                        (rig / "color").string(), "--board", "charuco:5x5:80mm:60mm:DICT_6X6_250",
                        "--camera", file("camera.yaml"), "--depth", (rig / "depth").string()}));
  EXPECT_EQ(json["depth_agreement"]["views"], 5);
  EXPECT_LT(json["depth_agreement"]["median"].get<double>(), 4e-3);
}

// Depth ----------------------------------------------------------------------------------------

class CalibrateDrawnDepth : public CalibrateRig {
 protected:
  static constexpr double kScale = 1.03, kOffset = 0.012;  ///< true = scale * measured + offset

  /// A sheet with two tags from twelve places; depth by the drawing, wrong by scale and offset.
  void draw(int places) const {
    const Board board = read_board("tags:2x1:80mm:40mm:tag36h11").value();
    const BoardPaint paint(board);
    Manifest manifest{.camera = kSmallCamera, .depth_scale = 1000.0};
    for (int id = 0; id < 2; ++id) {
      MarkerEntry marker;
      marker.id = {"tag36h11", id};
      marker.size = board.tag_side;
      marker.T_parent_marker = Pose::from_translation(
          {id * board.pitch + 0.5 * board.tag_side, 0.5 * board.tag_side, 0.0});
      manifest.markers.push_back(marker);
    }
    std::filesystem::create_directory(file("recording"));
    RecordingWriter writer(file("recording"), manifest);
    Random random(5);
    for (int place = 0; place < places; ++place) {
      const double tilt = place % 2 == 0 ? 0.35 : -0.3;
      const Pose T_camera_board =
          looking_at(board, 0.3 + 0.035 * place, tilt, 0.2 * std::sin(place), 0.1 * place);
      const Stamp stamp = Stamp::from_seconds(1.0 + 0.1 * place);
      ASSERT_TRUE(writer.add_frame(stamp, draw_board(paint, kSmallCamera, T_camera_board), stamp,
                                   depth_of(T_camera_board, random)));
    }
    ASSERT_TRUE(writer.finish());
  }

 private:
  static DepthImage depth_of(const Pose& T_camera_board, Random& random) {
    const Eigen::Vector3d normal = T_camera_board.rotation() * Eigen::Vector3d::UnitZ();
    const double distance = normal.dot(T_camera_board.translation());
    DepthImage depth(kSmallCamera.width, kSmallCamera.height);
    for (int y = 0; y < depth.height(); ++y) {
      for (int x = 0; x < depth.width(); ++x) {
        const double z = distance / normal.dot(kSmallCamera.unproject(Eigen::Vector2d(x, y), 1.0));
        depth(x, y) = static_cast<float>((z - kOffset) / kScale + 1e-3 * random.normal());
      }
    }
    return depth;
  }
};

TEST_F(CalibrateDrawnDepth, FindsScaleAndOffsetWhichTheRecordingThenUses) {
  draw(12);
  const nlohmann::json json = found({"depth", file("recording")});
  EXPECT_EQ(json["places"], 12);
  EXPECT_NEAR(json["scale"].get<double>(), kScale, 4.0 * json["scale_std"].get<double>());
  EXPECT_NEAR(json["offset"].get<double>(), kOffset, 4.0 * json["offset_std"].get<double>());
  EXPECT_LT(json["scale_std"].get<double>(), 0.01);
  EXPECT_LT(json["held_out_rms"].get<double>(), 0.2 * json["before_rms"].get<double>());
  // With the calibration, the same recording agrees with its tags.
  std::filesystem::copy(file("out.yaml"), file("recording/depth.yaml"));
  const std::string manifest = read_file(file("recording/recording.yaml")).value();
  write("recording/recording.yaml", manifest + "calibration: depth.yaml\n");
  const nlohmann::json again = run_json(command({"depth", file("recording")}));
  EXPECT_NEAR(again["scale"].get<double>(), 1.0, 1e-3);
  EXPECT_NEAR(again["offset"].get<double>(), 0.0, 1e-3);
  expect_in("agrees", again["verdict"].get<std::string>());
}

TEST_F(CalibrateDrawnDepth, NamesWhatIsMissing) {
  draw(3);
  expect_in("3 places", failure({"depth", file("recording")}));
  const std::string manifest = read_file(file("recording/recording.yaml")).value();
  write("recording/recording.yaml", manifest.substr(0, manifest.find("markers:")));
  expect_in("lists no tags", failure({"depth", file("recording")}));
  std::filesystem::remove(file("recording/depth.txt"));
  std::filesystem::remove_all(file("recording/depth"));
  expect_in("no depth images", failure({"depth", file("recording")}));
}

// Tags -----------------------------------------------------------------------------------------

class CalibrateCornerTable : public CalibrateRig {
 protected:
  /// Three tags, of which the third is stated `shift` [m] from where it is.
  void make(double shift) const {
    write("camera.yaml", "camera: {width: 320, height: 240, fx: 290, fy: 288, cx: 161, cy: 118}\n");
    const std::vector<Eigen::Vector3d> places{{0, 0, 0}, {0.3, 0.05, 0}, {0.1, 0.3, 0}};
    std::string stated = "tag_bundles:\n  - name: base\n    layout:\n";
    for (std::size_t i = 0; i < places.size(); ++i) {
      stated += fmt::format("      - {{id: {}, size: 0.12, x: {}, y: {}, z: 0}}\n", i,
                            places[i].x() + (i == 2 ? shift : 0.0), places[i].y());
    }
    write("stated.yaml", stated);
    Random random(2);
    std::string table = "t,id,u0,v0,u1,v1,u2,v2,u3,v3\n";
    for (int view = 0; view < 15; ++view) {
      const double angle = 0.4 * view;
      const Eigen::Vector3d eye(0.15 + 0.5 * std::cos(angle), 0.1 + 0.5 * std::sin(angle), 0.9);
      const Eigen::Vector3d z = (Eigen::Vector3d(0.15, 0.1, 0.0) - eye).normalized();
      const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
      Eigen::Matrix3d R;
      R << x, z.cross(x), z;
      const Pose T_camera_base = Pose(Eigen::Quaterniond(R), eye).inverse();
      for (std::size_t i = 0; i < places.size(); ++i) {
        table += fmt::format("{},{}", 0.1 * view, i);
        for (const Eigen::Vector3d& corner : tag_corners(0.12)) {
          const Eigen::Vector2d pixel = kSmallCamera.project(T_camera_base * (corner + places[i]));
          table += fmt::format(",{},{}", pixel.x() + 0.05 * random.normal(),
                               pixel.y() + 0.05 * random.normal());
        }
        table += '\n';
      }
    }
    write("corners.csv", table);
  }
  [[nodiscard]] std::vector<std::string> tags(const std::vector<std::string>& more) const {
    std::vector<std::string> what{"tags",     file("corners.csv"), "--camera", file("camera.yaml"),
                                  "--layout", file("stated.yaml")};
    what.insert(what.end(), more.begin(), more.end());
    return what;
  }
};

TEST_F(CalibrateCornerTable, NamesTheTagThatIsElsewhere) {
  make(0.058);
  const nlohmann::json json = found(tags({}));
  expect_in("tag36h11:2", json["verdict"].get<std::string>());
  const nlohmann::json& moved = json["bodies"][0]["tags"][2];
  EXPECT_NEAR(moved["from_stated"]["offset"].get<double>(), 0.058, 1e-3);
  EXPECT_NEAR(moved["position"][0].get<double>(), 0.1, 1e-3);
  expect_in("covariance:", read_file(file("out.yaml")).value());
}

TEST_F(CalibrateCornerTable, NamesWhatIsWrongWithTheTable) {
  make(0.0);
  expect_in("no such tag", failure(tags({"--fixed", "17"})));
  const std::string table = read_file(file("corners.csv")).value();
  write("corners.csv", table.substr(0, table.size() - 30));
  expect_in("corners.csv:46", failure(tags({})));
  write("corners.csv", "t,id,x,y\n0,0,1,2\n");
  expect_in("no columns of tag corners", failure(tags({})));
}

// Force ----------------------------------------------------------------------------------------

class CalibrateForceTable : public CalibrateRig {
 protected:
  void make(double max_tilt, double gain) const {
    Random random(4);
    std::string table = "index,x,y,z,qx,qy,qz,qw,fx,fy,fz\n";
    for (int i = 0; i < 16; ++i) {
      Vector6d turn = Vector6d::Zero();
      turn.tail<3>() = normal_vector(random, 1.0).normalized() * random.uniform(0.0, max_tilt);
      const Eigen::Quaterniond q = Pose::exp(turn).rotation();
      const Eigen::Vector3d force =
          Eigen::Vector3d(1.0, -2.0, 3.0) +
          gain * 1.3 * (q.conjugate() * Eigen::Vector3d(0.0, 0.0, -kStandardGravity)) +
          normal_vector(random, 0.1);
      table += fmt::format("{},0.4,0,0.3,{},{},{},{},{},{},{}\n", i, q.x(), q.y(), q.z(), q.w(),
                           force.x(), force.y(), force.z());
    }
    write("force.csv", table);
  }
};

TEST_F(CalibrateForceTable, FindsLoadAndBias) {
  make(2.5, 1.0);
  const nlohmann::json json = found({"force", file("force.csv")});
  EXPECT_NEAR(json["mass"].get<double>(), 1.3, 0.02);
  EXPECT_NEAR(json["force_bias"][1].get<double>(), -2.0, 0.2);
  expect_in("kind: force", read_file(file("out.yaml")).value());
}

TEST_F(CalibrateForceTable, NamesWhatTheLogDoesNotShow) {
  make(0.01, 1.0);
  expect_in("the poses do not show the sensor's axes", failure({"force", file("force.csv")}));
  make(2.5, 0.0);  // without a load
  expect_in("the readings do not change with the pose", failure({"force", file("force.csv")}));
  write("force.csv", "index,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n");
  expect_in("force.csv", failure({"force", file("force.csv")}));
}

// Touch ----------------------------------------------------------------------------------------

TEST_F(CalibrateRig, FindsAWorldByTouchedPoints) {
  const Pose T_base_world(Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ())),
                          {0.4, -0.1, 0.02});
  Random random(8);
  std::string table = "name,x_mm,y_mm,z_mm,base_x,base_y,base_z\n";
  std::string mirrored = table, line = table;
  const std::vector<Eigen::Vector3d> points{
      {0, 0, 0}, {0.4, 0, 0}, {0.4, 0.3, 0.0}, {0, 0.3, 0.1}, {0.2, 0.1, 0.05}};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p = T_base_world * points[i] + normal_vector(random, 2e-4);
    const auto row = [&](double x, double y, double z, const Eigen::Vector3d& touched) {
      return fmt::format("p{},{},{},{},{},{},{}\n", i, 1e3 * x, 1e3 * y, 1e3 * z, touched.x(),
                         touched.y(), touched.z());
    };
    table += row(points[i].x(), points[i].y(), points[i].z(), p);
    mirrored += row(-points[i].x(), points[i].y(), points[i].z(), p);
    line += row(0.1 * static_cast<double>(i), 0, 0,
                T_base_world * Eigen::Vector3d(0.1 * static_cast<double>(i), 0, 0));
  }
  write("points.csv", table);
  const nlohmann::json json = found({"touch", file("points.csv")});
  EXPECT_NEAR(json["position"][0].get<double>(), 0.4, 1e-3);
  EXPECT_NEAR(json["scale"].get<double>(), 1.0, 5e-3);
  write("points.csv", mirrored);
  expect_in("mirrored", failure({"touch", file("points.csv")}));
  write("points.csv", line);
  expect_in("line", failure({"touch", file("points.csv")}));
}

// Objects --------------------------------------------------------------------------------------

class CalibrateTouchedBox : public CalibrateRig {
 protected:
  const Eigen::Vector3d half_{0.1, 0.07, 0.05};
  const Pose T_tracked_object_{
      Eigen::Quaterniond(Eigen::AngleAxisd(-0.6, Eigen::Vector3d::UnitZ())), {0.012, -0.02, 0.0}};

  /// A box on a table that a tip touches at its four sides, as its tracker sees it.
  void make(int contacts) const {
    const Pose T_base_object = Pose::from_translation({0.5, 0.1, 0.05});
    std::filesystem::create_directories(file("recording/tracked/objects/box"));
    RecordingWriter writer(
        file("recording"),
        {.objects = {{.name = "box", .mesh = "objects/box.obj"}}, .tool_radius = 0.01});
    ASSERT_TRUE(
        writer.write_object_mesh("objects/box.obj", test::box_mesh((2.0 * half_).cast<float>())));
    Random random(3);
    Trajectory tool, tracked;
    std::vector<WrenchSample> wrench;
    for (int i = 0; i < 100 * contacts; ++i) {
      const int contact = i / 100, axis = contact % 2;
      const double sign = contact % 4 < 2 ? 1.0 : -1.0;
      const bool is_touching = i % 100 >= 40 && i % 100 < 80;
      Eigen::Vector3d p;
      p[axis] = sign * (half_[axis] + 0.01 + (is_touching ? 2e-4 * random.normal() : 0.03));
      p[1 - axis] = 0.03 * std::sin(1.7 * contact);
      const Stamp stamp = Stamp::from_seconds(1.0 + 0.01 * i);
      tool.append(stamp, Pose::from_translation(T_base_object * p));
      Eigen::Vector3d force = 0.05 * normal_vector(random, 1.0);
      if (is_touching) force[axis] -= 5.0 * sign;
      wrench.push_back({stamp, force, Eigen::Vector3d::Zero()});
      tracked.append(stamp, T_base_object * T_tracked_object_.inverse());
    }
    ASSERT_TRUE(writer.write_tool(tool));
    ASSERT_TRUE(writer.write_wrench(wrench));
    ASSERT_TRUE(writer.finish());
    write("recording/tracked/objects/box/tracked.txt", format_trajectory(tracked));
  }
};

TEST_F(CalibrateTouchedBox, FindsTheMeshInTheTrackersFrameWhichTheRecordingThenUses) {
  make(12);
  const nlohmann::json box = found({"objects", file("recording")})["objects"][0];
  EXPECT_EQ(box["contacts"], 12);
  for (const std::size_t axis : {0U, 1U}) {
    EXPECT_NEAR(box["position"][axis].get<double>(),
                T_tracked_object_.translation()[static_cast<Eigen::Index>(axis)], 5e-4);
  }
  EXPECT_NEAR(2.0 * std::asin(box["rotation"][2].get<double>()), -0.6, 5e-3);
  expect_in("z", box["not_observable"].get<std::string>());
  std::filesystem::copy(file("out.yaml"), file("recording/objects.yaml"));
  const std::string manifest = read_file(file("recording/recording.yaml")).value();
  write("recording/recording.yaml", manifest + "calibration: [objects.yaml]\n");
  const nlohmann::json again = run_json(command({"objects", file("recording")}))["objects"][0];
  EXPECT_LT(again["before_rms"].get<double>(), 1e-3);
}

TEST_F(CalibrateTouchedBox, NamesWhatIsMissing) {
  make(3);
  expect_in("touched in 3 contacts", failure({"objects", file("recording")}));
  std::filesystem::remove_all(file("recording/tracked"));
  expect_in("tracked/objects/NAME/tracked.txt", failure({"objects", file("recording")}));
  std::filesystem::remove(file("recording/wrench.csv"));
  expect_in("wrench.csv", failure({"objects", file("recording")}));
}

// Doctor of what calibrations come from --------------------------------------------------------

TEST_F(CalibrateTouchedBox, DoctorHasATableForEachLogAndForWhatCannotBeRead) {
  make(4);
  std::filesystem::rename(file("recording"), file("a"));
  std::filesystem::create_directory(file("logs"));
  std::filesystem::copy(file("a"), file("logs/a"), std::filesystem::copy_options::recursive);
  std::filesystem::copy(file("a"), file("logs/b"), std::filesystem::copy_options::recursive);
  const std::string tool = read_file(file("a/tool.csv")).value();
  write("logs/b/tool.csv", tool.substr(0, tool.size() - 20));
  const CommandOutcome outcome = run_pcavr({"doctor", file("logs"), "--json"});
  EXPECT_EQ(outcome.exit_code, 3) << outcome.standard_error;
  const nlohmann::json json = nlohmann::json::parse(outcome.standard_output);
  ASSERT_EQ(json["logs"].size(), 2U);
  expect_in("tool.csv", json["logs"][1]["disagrees"].dump());
  expect_in("wrench.csv", json["logs"][1]["agrees"].dump());  // the rest is checked
  write("logs/b/recording.yaml", "format: pcavr-recording/1\nwrong: 1\n");
  const CommandOutcome unread = run_pcavr({"doctor", file("logs/b")});
  EXPECT_EQ(unread.exit_code, 3);
  expect_in("wrong", unread.standard_output);
  expect_in("could not be checked", unread.standard_output);
}

}  // namespace
}  // namespace pcavr
