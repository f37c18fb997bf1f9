// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Errors of the real command on shared recordings, against their ground truth. The bounds are the
// project's guarantees; the measured errors are printed.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/base/core/median.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/recordings/recording/frame_reader.hpp"

#include "support/json_command.hpp"
#include "support/shared_data.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr double kDegree = 3.14159265358979 / 180.0;
constexpr double kMillimetre = 1e-3;

TEST(PositionError, TabletopByAHandHeldCamera) {
  PCAVR_NEEDS_SHARED_DATA("tabletop/truth/camera.txt");
  const TemporaryFolder folder;
  const std::string recording = shared_data("tabletop").string();
  const std::string scene = (folder.path() / "scene").string();
  const json built = run_json({"build", recording, "-o", scene});
  EXPECT_GE(built["frames_used"].get<double>(), 0.95 * built["frames_recorded"].get<double>());

  const json report = run_json({"evaluate", scene, "--truth", recording + "/truth", "-o",
                                (folder.path() / "report").string()});
  expect_within(report, "camera.absolute.translation.rmse_m", 5.0 * kMillimetre);
  expect_within(report, "camera.absolute.rotation.rmse_rad", 0.4 * kDegree);
  expect_within(report, "mesh.accuracy.mean_m", 2.0 * kMillimetre);
  expect_within(report, "mesh.share_left_behind", 0.001);
  expect_within(report, "mesh.share_not_explained", 0.001);
  EXPECT_GE(report["mesh.completeness_10mm"].get<double>(), 0.95);
}

/// Every `step`-th line of a list of files.
void thin_list(const fs::path& from, const fs::path& to, int step) {
  std::istringstream lines(read_file(from).value());
  std::string kept;
  int row = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with('#') || row++ % step == 0) kept += line + '\n';
  }
  std::ofstream(to) << kept;
}

/// Every `step`-th frame of tabletop, with or without its true poses as given ones.
void expect_few_views_placed(int step, bool with_poses) {
  const fs::path whole = shared_data("tabletop");
  const TemporaryFolder folder;
  const fs::path recording = folder.path() / "few";
  fs::create_directory(recording);
  for (const char* name : {"depth", "rgb", "objects"}) {
    fs::create_directory_symlink(fs::absolute(whole / name), recording / name);
  }
  fs::copy_file(whole / "recording.yaml", recording / "recording.yaml");
  if (with_poses) fs::copy_file(whole / "truth/camera.txt", recording / "groundtruth.txt");
  for (const char* name : {"depth.txt", "rgb.txt"}) {
    thin_list(whole / name, recording / name, step);
  }
  // Only the camera is judged: a coarse mesh, and no truth of it.
  const fs::path truth = folder.path() / "truth";
  fs::create_directory(truth);
  fs::copy_file(whole / "truth/camera.txt", truth / "camera.txt");
  const std::string scene = (folder.path() / "scene").string();
  run_json({"build", recording.string(), "-o", scene, "--voxel", "0.02"});
  const json report = run_json(
      {"evaluate", scene, "--truth", truth.string(), "-o", (folder.path() / "report").string()});
  EXPECT_EQ(report["camera.absolute.translation.count"].get<int>(), 120 / step);
  expect_within(report, "camera.absolute.translation.rmse_m", 1.0 * kMillimetre);
  expect_within(report, "camera.absolute.rotation.rmse_rad", 0.1 * kDegree);
}

// Views 0.2 to 0.3 m apart: from the last one, the next aligns as well when it slides along the
// table.
TEST(PositionError, TabletopByAFewViewsWithGivenPoses) {
  PCAVR_NEEDS_SHARED_DATA("tabletop/truth/camera.txt");
  for (const int step : {10, 15, 20}) expect_few_views_placed(step, true);
}

TEST(PositionError, TabletopByAFewViewsWithATagInSome) {
  PCAVR_NEEDS_SHARED_DATA("tabletop/truth/camera.txt");
  for (const int step : {10, 12, 15, 20}) expect_few_views_placed(step, false);
}

TEST(PositionError, TwoBoxesThatAToolPushes) {
  PCAVR_NEEDS_SHARED_DATA("push_two_boxes/truth/camera.txt");
  const TemporaryFolder folder;
  const std::string recording = shared_data("push_two_boxes").string();
  const std::string scene = (folder.path() / "scene").string();
  const std::string run = (folder.path() / "run").string();
  run_json({"build", recording, "-o", scene});
  run_json({"replay", recording, "--scene", scene, "-o", run});

  const json built = run_json({"evaluate", scene, "--truth", recording + "/truth", "-o",
                               (folder.path() / "scene-report").string()});
  expect_within(built, "mesh.share_left_behind", 0.001);
  expect_within(built, "mesh.share_not_explained", 0.001);
  const json tracked = run_json({"evaluate", run, "--truth", recording + "/truth", "-o",
                                 (folder.path() / "run-report").string()});
  for (const std::string name : {"fp_box", "r_box"}) {
    const std::string key = "object." + name + ".tracked.";
    expect_within(tracked, key + "first_second.translation.median_m", 1.5 * kMillimetre);
    expect_within(tracked, key + "first_second.rotation.median_rad", 0.5 * kDegree);
    expect_within(tracked, key + "absolute.translation.rmse_m", 2.0 * kMillimetre);
  }
}

/// Every fifth frame of a recording is held out from its build, and then compared with the mesh.
class HeldOutFrames : public testing::TestWithParam<const char*> {};

constexpr std::size_t kHeldOut = 5;

/// Removes every fifth image from the lists (without written.yaml, so that the change is accepted).
void hold_out(const fs::path& recording) {
  fs::remove(recording / "written.yaml");
  for (const char* list : {"rgb.txt", "depth.txt"}) {
    std::istringstream lines(read_file(recording / list).value());
    std::string kept;
    std::size_t image = 0;
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with('#') || ++image % kHeldOut != 0) kept += line + '\n';
    }
    ASSERT_TRUE(write_file(recording / list, kept));
  }
}

TEST_P(HeldOutFrames, OfARealRoomLieOnItsMesh) {
  PCAVR_NEEDS_SHARED_DATA("real/seven_scenes/frame-000000.depth.png");
  const TemporaryFolder folder;
  const fs::path all = folder.path() / "all";
  const fs::path part = folder.path() / "part";
  run_json({"import", shared_data("real/seven_scenes").string(), "-o", all.string()});
  fs::copy(all, part, fs::copy_options::recursive);
  hold_out(part);
  std::vector<std::string> arguments = {"build", part.string(), "-o",
                                        (folder.path() / "scene").string()};
  if (*GetParam() != '\0') arguments.emplace_back(GetParam());
  run_json(arguments);

  const auto recording = read_recording(all);
  const auto mesh = read_mesh(folder.path() / "scene/mesh.ply");
  const auto camera = read_trajectory(folder.path() / "scene/camera_trajectory.txt");
  ASSERT_TRUE(recording && mesh && camera);
  const SurfaceQuery surface(*mesh);
  std::vector<double> distances;
  for (std::size_t i = kHeldOut - 1; i < recording->frames.size(); i += kHeldOut) {
    // The pose of a held-out frame is interpolated between its neighbours'.
    const auto T_base_camera = camera->at(recording->frames[i].depth_stamp);
    const auto frame = decode_frame(*recording, i);
    if (!T_base_camera || !frame) continue;
    for (int y = 0; y < frame->depth.height(); y += 8) {
      for (int x = 0; x < frame->depth.width(); x += 8) {
        const float z = frame->depth(x, y);
        if (z <= 0.0F || z > 4.0F) continue;
        const Eigen::Vector3f p_base =
            (*T_base_camera * recording->manifest.camera->unproject(Eigen::Vector2d(x, y), z))
                .cast<float>();
        const auto nearest = surface.closest(p_base, 0.05F);
        if (nearest) distances.push_back(std::abs(nearest->normal.dot(p_base - nearest->point)));
      }
    }
  }
  ASSERT_GT(distances.size(), 50'000U);
  std::printf("  held-out frames lie %.2f mm from the mesh (median, %zu readings)\n",
              1e3 * median(distances), distances.size());
  EXPECT_LE(median(distances), 6.0 * kMillimetre);
}

INSTANTIATE_TEST_SUITE_P(Poses, HeldOutFrames, testing::Values("", "--trust-poses"),
                         [](const auto& instance) {
                           return *instance.param == '\0' ? "Measured" : "Trusted";
                         });

}  // namespace
}  // namespace pcavr
