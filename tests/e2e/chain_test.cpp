// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// The whole chain by the real command, on a recording made for the purpose.
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "support/json_command.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Simulated and built once for all tests of this file.
class Chain : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    run_json({"simulate", "tabletop", "-o", place("recording"), "--seed", "11"});
    run_json({"build", place("recording"), "-o", place("scene"), "--voxel", "0.01"});
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  static std::string place(const std::string& name) { return (folder_->path() / name).string(); }

  static TemporaryFolder* folder_;
};
TemporaryFolder* Chain::folder_ = nullptr;

TEST_F(Chain, WritesEveryFileOfTheBundle) {
  for (const char* name : {"scene.yaml", "scene.glb", "mesh.ply", "cloud.ply", "occupancy.bt",
                           "camera_trajectory.txt", "preview.png"}) {
    EXPECT_GT(fs::file_size(fs::path(place("scene")) / name), 100U) << name;
  }
}

TEST_F(Chain, IsSoundToInspect) {
  EXPECT_TRUE(run_json({"inspect", place("scene")})["is_sound"].get<bool>());
  EXPECT_TRUE(run_json({"inspect", place("recording")})["is_sound"].get<bool>());
}

TEST_F(Chain, GivesTheSameBytesAtAnyNumberOfThreads) {
  run_json(
      {"build", place("recording"), "-o", place("scene-1"), "--voxel", "0.01", "--threads", "1"});
  run_json(
      {"build", place("recording"), "-o", place("scene-4"), "--voxel", "0.01", "--threads", "4"});
  const auto one = contents(place("scene-1"));
  const auto four = contents(place("scene-4"));
  ASSERT_EQ(one.size(), four.size());
  for (const auto& [name, content] : one) {
    EXPECT_TRUE(content == four.at(name)) << name << " differs";
  }
}

TEST_F(Chain, ReplaysAndEvaluates) {
  const json run =
      run_json({"replay", place("recording"), "--scene", place("scene"), "-o", place("run")});
  EXPECT_GT(run["frames_used"].get<int>(), 0);
  for (const std::string subject : {"scene", "run"}) {
    run_json({"evaluate", place(subject), "--truth", place("recording") + "/truth", "-o",
              place(subject + "-report")});
    EXPECT_GT(fs::file_size(place(subject + "-report") + "/report.html"), 1000U);
    EXPECT_FALSE(
        json::parse(read_file(place(subject + "-report") + "/report.json").value(), nullptr, false)
            .is_discarded());
  }
}

TEST_F(Chain, ForceReplacesAnOutput) {
  run_json({"simulate", "push", "-o", place("old"), "--no-images"});
  run_json({"simulate", "tabletop", "-o", place("old"), "--seed", "11", "--force"});
  EXPECT_TRUE(contents(place("old")) == contents(place("recording"))) << "same seed, other bytes";
}

}  // namespace
}  // namespace pcavr
