// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/results/evaluation/evaluate.hpp"

#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/geometry/trajectory.hpp"
#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/recordings/recording/recording.hpp"

#include "shapes.hpp"
#include "support/report_data.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// Positions in text files have seven decimals.
constexpr double kFileRounding = 2e-7;

void write(const fs::path& file, const std::string& content) {
  fs::create_directories(file.parent_path());
  ASSERT_TRUE(write_file(file, content).has_value());
}

std::string as_obj(const TriangleMesh& mesh) {
  std::string text;
  for (const Eigen::Vector3f& v : mesh.vertices) {
    text += "v " + std::to_string(v.x()) + ' ' + std::to_string(v.y()) + ' ' +
            std::to_string(v.z()) + '\n';
  }
  for (const auto& t : mesh.triangles) {
    text += "f " + std::to_string(t[0] + 1) + ' ' + std::to_string(t[1] + 1) + ' ' +
            std::to_string(t[2] + 1) + '\n';
  }
  return text;
}

std::string as_ply(const TriangleMesh& mesh) {
  std::string text = "ply\nformat ascii 1.0\nelement vertex " +
                     std::to_string(mesh.vertices.size()) +
                     "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                     std::to_string(mesh.triangles.size()) +
                     "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const Eigen::Vector3f& v : mesh.vertices) {
    text +=
        std::to_string(v.x()) + ' ' + std::to_string(v.y()) + ' ' + std::to_string(v.z()) + '\n';
  }
  for (const auto& t : mesh.triangles) {
    text += "3 " + std::to_string(t[0]) + ' ' + std::to_string(t[1]) + ' ' + std::to_string(t[2]) +
            '\n';
  }
  return text;
}

/// A camera that circles 1 m above the floor and looks down, 20 poses a second for 3 s.
Trajectory a_circling_camera() {
  Trajectory camera;
  for (int i = 0; i <= 60; ++i) {
    const double angle = 0.1 * i;
    const Eigen::Quaterniond down(Eigen::AngleAxisd(std::acos(-1.0), Eigen::Vector3d::UnitX()));
    camera.append(Stamp::from_seconds(0.05 * i),
                  Pose(down, {0.2 * std::cos(angle), 0.2 * std::sin(angle), 1.0 + 0.01 * angle}));
  }
  return camera;
}

/// A cube that is pushed by 10 mm between 1 s and 2 s; 100 poses a second.
Trajectory a_pushed_cube() {
  Trajectory cube;
  for (int i = 0; i <= 300; ++i) {
    const double x = 0.01 * std::clamp(0.01 * i - 1.0, 0.0, 1.0);
    cube.append(Stamp::from_seconds(0.01 * i), Pose::from_translation({x, 0, 0.05}));
  }
  return cube;
}

Trajectory shifted(const Trajectory& trajectory, const Eigen::Vector3d& by) {
  Trajectory result;
  for (const TimedPose& timed : trajectory.poses()) {
    result.append(timed.stamp, Pose::from_translation(by) * timed.pose);
  }
  return result;
}

TriangleMesh the_floor(float height) { return a_plane(-0.4F, 0.4F, -0.3F, 0.3F, height); }

/// A folder with a recording's manifest and truth; scenes and runs are added by the tests.
class Evaluate : public testing::Test {
 protected:
  void SetUp() override {
    write(recording() / "recording.yaml",
          "format: pcavr-recording/1\n"
          "camera: {width: 128, height: 96, fx: 100, fy: 100, cx: 63.5, cy: 47.5, "
          "depth_scale: 1000}\n"
          "objects:\n  - {name: cube, mesh: objects/cube.obj, movable: true}\n");
    write(recording() / "objects/cube.obj", as_obj(a_box({0.1F, 0.1F, 0.1F})));
    write(truth() / "camera.txt", format_trajectory(a_circling_camera()));
    write(truth() / "objects/cube.txt", format_trajectory(a_pushed_cube()));
    write(truth() / "scene.ply", as_ply(the_floor(0.0F)));
    fs::create_directories(report());
  }

  void write_run(const std::string& name, const Trajectory& tracked) {
    write(folder_.path() / name / "run.yaml",
          "format: pcavr-run/1\nrecording: " + recording().string() + "\n");
    write(folder_.path() / name / "objects/cube/tracked.txt", format_trajectory(tracked));
  }

  void write_a_scene(const std::string& name, const TriangleMesh& mesh_base,
                     const Eigen::Vector3d& offset) {
    Scene scene;
    scene.mesh_base = mesh_base;
    compute_vertex_normals(scene.mesh_base);
    scene.mesh_base.colors.resize(mesh_base.vertices.size());
    SceneObject cube;
    cube.model = {.name = "cube",
                  .mesh_object = a_box({0.1F, 0.1F, 0.1F}),
                  .volume = 1e-3,
                  .centre_of_mass_object = Eigen::Vector3d::Zero()};
    compute_vertex_normals(cube.model.mesh_object);
    cube.T_base_object_start = Pose::from_translation(offset + Eigen::Vector3d(0, 0, 0.05));
    cube.T_base_object = Pose::from_translation(offset + Eigen::Vector3d(0.01, 0, 0.05));
    cube.evidence = "tags";
    scene.objects.push_back(std::move(cube));
    scene.camera_trajectory = shifted(a_circling_camera(), offset);
    scene.quality.frames_used = scene.camera_trajectory.size();
    scene.quality.frames_recorded = scene.quality.frames_used;
    scene.recording = recording().string();
    scene.voxel_size = 0.005;
    const fs::path folder = folder_.path() / name;
    fs::create_directories(folder);
    const Expected<void> written = write_scene(scene, folder, Parallelism{2});
    ASSERT_TRUE(written.has_value()) << written.error().to_string();
  }

  [[nodiscard]] Expected<std::string> evaluate_against_truth(const fs::path& subject) const {
    return evaluate({subject, truth()}, report(), Parallelism{2});
  }

  [[nodiscard]] fs::path recording() const { return folder_.path() / "recording"; }
  [[nodiscard]] fs::path truth() const { return recording() / "truth"; }
  [[nodiscard]] fs::path report() const { return folder_.path() / "report"; }

  TemporaryFolder folder_;
};

TEST_F(Evaluate, SeparatesErrorsAtRestAndMoving) {
  // 2 mm off while the cube rests, 5 mm while it moves.
  const Trajectory truth_poses = a_pushed_cube();
  Trajectory tracked;
  for (const TimedPose& timed : truth_poses.poses()) {
    const double t = timed.stamp.seconds();
    const double off = t > 1.0 && t < 2.0 ? 0.005 : 0.002;
    tracked.append(timed.stamp, Pose::from_translation({0, off, 0}) * timed.pose);
  }
  write_run("run", tracked);
  const Expected<std::string> json = evaluate_against_truth(folder_.path() / "run");
  ASSERT_TRUE(json.has_value()) << json.error().to_string();
  const Json metrics = Json::parse(*json);
  const std::string key = "object.cube.tracked.";
  EXPECT_EQ(metrics[key + "absolute.translation.count"], 301);
  EXPECT_NEAR(metrics[key + "first_second.translation.median_m"], 0.002, kFileRounding);
  EXPECT_NEAR(metrics[key + "at_rest.translation.median_m"], 0.002, kFileRounding);
  EXPECT_NEAR(metrics[key + "moving.translation.median_m"], 0.005, kFileRounding);
  EXPECT_NEAR(metrics[key + "add.max_m"], 0.005, kFileRounding);
  EXPECT_NEAR(metrics[key + "mssd.min_m"], 0.002, kFileRounding);
  EXPECT_EQ(metrics[key + "absolute.rotation.max_rad"], 0.0);
}

TEST_F(Evaluate, ComparesEverythingInASceneWithTheTruth) {
  // Everything is 3 mm off along y; the mesh 2 mm along z, with a residue inside the cube.
  const TriangleMesh residue = a_plane(-0.02F, 0.02F, -0.02F, 0.02F, 0.05F);
  write_a_scene("scene", merged(the_floor(0.002F), residue), {0, 0.003, 0});
  const Expected<std::string> json = evaluate_against_truth(folder_.path() / "scene");
  ASSERT_TRUE(json.has_value()) << json.error().to_string();
  const Json metrics = Json::parse(*json);
  EXPECT_NEAR(metrics["camera.absolute.translation.rmse_m"], 0.003, kFileRounding);
  EXPECT_NEAR(metrics["camera.absolute_aligned.translation.rmse_m"], 0.0, kFileRounding);
  EXPECT_NEAR(metrics["camera.relative.translation.max_m"], 0.0, kFileRounding);
  EXPECT_EQ(metrics["camera.unmatched"], 0);
  EXPECT_NEAR(metrics["placed.cube.start.translation_m"], 0.003, kFileRounding);
  EXPECT_NEAR(metrics["placed.cube.end.add_m"], 0.003, kFileRounding);
  EXPECT_NEAR(metrics["mesh.accuracy.median_m"], 0.002, 1e-6);
  EXPECT_EQ(metrics["mesh.completeness_5mm"], 1.0);
  const double share = 0.0016 / (0.48 + 0.0016);  // exact to a sample of 25 mm^2
  EXPECT_NEAR(metrics["mesh.share_left_behind"], share, 2 * 25e-6 / 0.48);
  EXPECT_NEAR(metrics["mesh.share_not_explained"], share, 2 * 25e-6 / 0.48);
}

TEST_F(Evaluate, ComparesTwoRuns) {
  write_run("one", a_pushed_cube());
  write_run("two", shifted(a_pushed_cube(), {0.001, 0, 0}));
  const Expected<std::string> json =
      evaluate({folder_.path() / "two", folder_.path() / "one"}, report(), Parallelism{1});
  ASSERT_TRUE(json.has_value()) << json.error().to_string();
  const Json metrics = Json::parse(*json);
  EXPECT_EQ(metrics["reference_kind"], "run");
  EXPECT_NEAR(metrics["object.cube.tracked.add.rmse_m"], 0.001, kFileRounding);
}

TEST_F(Evaluate, WritesTheReportThatItReturnsAndItsPage) {
  write_run("run", a_pushed_cube());
  const Expected<std::string> json = evaluate_against_truth(folder_.path() / "run");
  ASSERT_TRUE(json.has_value());
  EXPECT_EQ(*read_file(report() / "report.json"), *json);
  const std::string text = report_data(report());
  EXPECT_EQ(text.find("nan"), std::string::npos);
  const Json data = Json::parse(text);
  EXPECT_EQ(data["title"], "Position errors: " + (folder_.path() / "run").string());
  const Json& section = data["sections"].back();
  EXPECT_EQ(section["title"], "cube, tracked");
  EXPECT_EQ(section["blocks"][0]["plots"].size(), 3U);
  EXPECT_FALSE(section["blocks"][0]["plots"][0]["series"][0]["y"].empty());
  EXPECT_EQ(section["blocks"][1]["tables"][0]["columns"][0], "error");
}

TEST_F(Evaluate, ShowsNoPlotOfAFixedCamerasConstantError) {
  const auto fixed = [](double x) {
    Trajectory camera;
    for (int i = 0; i <= 60; ++i)
      camera.append(Stamp::from_seconds(0.05 * i), Pose::from_translation({x, 0, 1.0}));
    return format_trajectory(camera);
  };
  write(truth() / "camera.txt", fixed(0.0));
  write_a_scene("scene", the_floor(0.0F), {0, 0, 0});
  write(folder_.path() / "scene/camera_trajectory.txt", fixed(0.001));
  ASSERT_TRUE(evaluate_against_truth(folder_.path() / "scene").has_value());
  const Json data = Json::parse(report_data(report()));
  const Json& section = data["sections"].front();
  EXPECT_EQ(section["title"], "Camera in base");
  ASSERT_EQ(section["blocks"].size(), 1U);
  const Json& table = section["blocks"][0]["tables"][0];
  EXPECT_EQ(table["title"], "Errors");
  EXPECT_EQ(table["rows"][0][0], "position, absolute");
}

TEST_F(Evaluate, KeepsNamesThatAreMarkup) {
  write(truth() / "objects/<b>&.txt", format_trajectory(a_pushed_cube()));
  write_run("run", a_pushed_cube());
  ASSERT_TRUE(evaluate_against_truth(folder_.path() / "run").has_value());
  const std::string text = report_data(report());
  EXPECT_EQ(text.find("<b>&"), std::string::npos);
  EXPECT_EQ(Json::parse(text)["notes"][0], "<b>& has no pose in this run.");
}

TEST_F(Evaluate, CountsPosesOutsideTheTruthsTimeSpan) {
  Trajectory tracked = a_pushed_cube();
  tracked.append(Stamp::from_seconds(3.5), Pose());
  write_run("run", tracked);
  const Json metrics = Json::parse(*evaluate_against_truth(folder_.path() / "run"));
  EXPECT_EQ(metrics["object.cube.tracked.unmatched"], 1);
}

TEST_F(Evaluate, ListsObjectsMissingInTheSubject) {
  write(truth() / "objects/ball.txt", format_trajectory(a_pushed_cube()));
  write_run("run", a_pushed_cube());
  std::string warnings;
  const Observer observer{.progress = {}, .warn = [&](std::string_view line) { warnings += line; }};
  const Expected<std::string> json =
      evaluate({folder_.path() / "run", truth()}, report(), Parallelism{1}, observer);
  ASSERT_TRUE(json.has_value());
  EXPECT_EQ(Json::parse(*json)["objects_missing"], Json({"ball"}));
  EXPECT_NE(warnings.find("ball"), std::string::npos);
}

TEST_F(Evaluate, IsTheSameBytesForAnyNumberOfThreads) {
  write_a_scene("scene", the_floor(0.002F), {0, 0, 0});
  const fs::path scene = folder_.path() / "scene";
  const std::string one = *evaluate({scene, truth()}, report(), Parallelism{1});
  const std::string data = report_data(report());
  for (const int threads : {2, 4}) {
    EXPECT_EQ(one, *evaluate({scene, truth()}, report(), Parallelism{threads}));
    EXPECT_EQ(data, report_data(report()));
  }
}

TEST_F(Evaluate, FailsWhereTheTruthIsMissing) {
  write_run("run", a_pushed_cube());
  const auto result =
      evaluate({folder_.path() / "run", recording() / "no_truth"}, report(), Parallelism{1});
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().file, (recording() / "no_truth").string());
  EXPECT_FALSE(fs::exists(report() / "report.json"));
}

TEST_F(Evaluate, FailsForAFolderOfUnknownKind) {
  const auto result = evaluate({folder_.path(), truth()}, report(), Parallelism{1});
  ASSERT_FALSE(result.has_value());
  EXPECT_NE(result.error().to_string().find("scene.yaml"), std::string::npos);
}

TEST_F(Evaluate, FailsWithoutACommonTimeSpan) {
  Trajectory later;
  later.append(Stamp::from_seconds(1000.0), Pose());
  write_run("run", later);
  const auto result = evaluate_against_truth(folder_.path() / "run");
  ASSERT_FALSE(result.has_value());
  EXPECT_NE(result.error().message.find("1000.000000"), std::string::npos);
}

TEST_F(Evaluate, FailsWithoutCommonData) {
  write_run("run", a_pushed_cube());
  fs::remove_all(truth() / "objects");
  const auto result = evaluate_against_truth(folder_.path() / "run");
  ASSERT_FALSE(result.has_value());
  EXPECT_NE(result.error().message.find("nothing in common"), std::string::npos);
}

TEST_F(Evaluate, NamesTheLineOfABadTruth) {
  write_run("run", a_pushed_cube());
  write(truth() / "objects/cube.txt", "0.0 0 0 0 0 0 0 1\n0.1 nan 0 0 0 0 0 1\n");
  const auto result = evaluate_against_truth(folder_.path() / "run");
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().file, (truth() / "objects/cube.txt").string());
  EXPECT_EQ(result.error().line, 2);
}

}  // namespace
}  // namespace pcavr
