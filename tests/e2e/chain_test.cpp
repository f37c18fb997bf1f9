// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// The whole chain with the real command, on a simulated recording.
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "support/json_command.hpp"
#include "support/report_data.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Simulated and built once for all tests of this file.
class Chain : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    run_json({"simulate", "tabletop", "-o", path_of("recording"), "--seed", "11",
              "--frames-per-second", "10"});
    run_json({"build", path_of("recording"), "-o", path_of("scene"), "--voxel", "0.01"});
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  static std::string path_of(const std::string& name) { return (folder_->path() / name).string(); }

  static TemporaryFolder* folder_;
};
TemporaryFolder* Chain::folder_ = nullptr;

TEST_F(Chain, WritesEveryFileOfTheBundle) {
  for (const char* name : {"scene.yaml", "scene.glb", "mesh.ply", "cloud.ply", "cloud.pcd",
                           "occupancy.bt", "camera_trajectory.txt", "preview.png"}) {
    EXPECT_GT(fs::file_size(fs::path(path_of("scene")) / name), 100U) << name;
  }
}

TEST_F(Chain, IsSoundToInspect) {
  EXPECT_TRUE(run_json({"inspect", path_of("scene")})["is_sound"].get<bool>());
  EXPECT_TRUE(run_json({"inspect", path_of("recording")})["is_sound"].get<bool>());
}

TEST_F(Chain, GivesTheSameBytesAtAnyNumberOfThreads) {
  run_json({"build", path_of("recording"), "-o", path_of("scene-1"), "--voxel", "0.01", "--threads",
            "1"});
  run_json({"build", path_of("recording"), "-o", path_of("scene-4"), "--voxel", "0.01", "--threads",
            "4"});
  const auto one = contents(path_of("scene-1"));
  const auto four = contents(path_of("scene-4"));
  ASSERT_EQ(one.size(), four.size());
  for (const auto& [name, content] : one) {
    EXPECT_TRUE(content == four.at(name)) << name << " differs";
  }
}

TEST_F(Chain, ReplaysAndEvaluates) {
  const json run =
      run_json({"replay", path_of("recording"), "--scene", path_of("scene"), "-o", path_of("run")});
  EXPECT_GT(run["frames_used"].get<int>(), 0);
  for (const std::string subject : {"scene", "run"}) {
    run_json({"evaluate", path_of(subject), "--truth", path_of("recording") + "/truth", "-o",
              path_of(subject + "-report")});
    EXPECT_GT(report_data(path_of(subject + "-report")).size(), 1000U);
    EXPECT_FALSE(json::parse(read_file(path_of(subject + "-report") + "/report.json").value(),
                             nullptr, false)
                     .is_discarded());
  }
}

TEST_F(Chain, ComparesTheObjectsOfASceneWithoutImages) {
  run_json({"simulate", "push", "-o", path_of("unseen"), "--no-images"});
  run_json({"build", path_of("unseen"), "-o", path_of("unseen-scene")});
  const json report = run_json({"evaluate", path_of("unseen-scene"), "--truth",
                                path_of("unseen") + "/truth", "-o", path_of("unseen-report")});
  EXPECT_LT(report["placed.box_1.start.translation_m"].get<double>(), 1e-3);
  EXPECT_FALSE(report.contains("placed.box_1.end.translation_m")) << "it was not tracked";
  EXPECT_FALSE(report.contains("mesh.completeness_5mm")) << "there is no surface";
}

TEST_F(Chain, ForceReplacesAnOutput) {
  run_json({"simulate", "push", "-o", path_of("old"), "--no-images"});
  run_json({"simulate", "tabletop", "-o", path_of("old"), "--seed", "11", "--frames-per-second",
            "10", "--force"});
  EXPECT_TRUE(contents(path_of("old")) == contents(path_of("recording")))
      << "same seed, different bytes";
}

}  // namespace
}  // namespace pcavr
