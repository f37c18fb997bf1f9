// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// pcavr build by tiles, and within a memory, with the real command on a simulated room.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/perception/scene/ply_file.hpp"

#include "support/json_command.hpp"
#include "support/running_command.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

class Tiles : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    run_json({"simulate", "room", "--seed", "5", "--duration", "4", "--frames-per-second", "5",
              "--image-size", "320x240", "-o", path("room")});
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  static std::string path(const std::string& name) { return (folder_->path() / name).string(); }
  static TriangleMesh mesh(const std::string& scene) {
    return read_ply(path(scene + "/mesh.ply")).value();
  }
  static std::string file(const std::string& name) { return read_file(path(name)).value(); }

 private:
  static TemporaryFolder* folder_;
};
TemporaryFolder* Tiles::folder_ = nullptr;

/// Corners of all triangles, each from its smallest one on, in order.
std::vector<std::array<std::array<float, 3>, 3>> sorted_triangles(const TriangleMesh& mesh) {
  std::vector<std::array<std::array<float, 3>, 3>> all;
  for (const auto& t : mesh.triangles) {
    auto& triangle = all.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector3f& p = mesh.vertices.at(t[i]);
      triangle[i] = {p.x(), p.y(), p.z()};
    }
    std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()),
                triangle.end());
  }
  std::sort(all.begin(), all.end());
  return all;
}

TEST_F(Tiles, GiveTheMeshOfTheWholeAndAWholeScene) {
  run_json({"build", path("room"), "-o", path("whole"), "--voxel", "0.02"});
  const auto built =
      run_json({"build", path("room"), "-o", path("tiled"), "--voxel", "0.02", "--tiles", "1"});
  EXPECT_TRUE(sorted_triangles(mesh("tiled")) == sorted_triangles(mesh("whole")));
  // What does not come from the tiles has the same bytes.
  for (const char* name : {"occupancy.bt", "camera_trajectory.txt"}) {
    EXPECT_EQ(file("tiled/" + std::string(name)), file("whole/" + std::string(name))) << name;
  }
  const auto points = [](const std::string& scene) {
    return static_cast<double>(read_ply(path(scene + "/cloud.ply")).value().vertices.size());
  };
  EXPECT_NEAR(points("tiled"), points("whole"), 0.01 * points("whole"))
      << "outliers are relative to the mean of a tile";
  EXPECT_EQ(run_pcavr({"inspect", path("tiled")}).exit_code, 0);
  run_json({"build", path("room"), "-o", path("again"), "--voxel", "0.02", "--tiles", "1",
            "--threads", "1"});
  EXPECT_EQ(file("again/mesh.ply"), file("tiled/mesh.ply"));
  EXPECT_EQ(file("again/scene.glb"), file("tiled/scene.glb"));
}

// Each step as a process of its own, one run killed in the midst: the bytes of one command.
TEST_F(Tiles, AreFusedByTasksOfAPlan) {
  std::ofstream(path("coarse.yaml")) << "reconstruction.fusion:\n  voxel_size: 0.02\n";
  const std::vector<std::string> config{"--config", path("coarse.yaml")};
  run_json({"plan", path("room"), "--chain", "build", "--tiles", "1", "--parts", "2", "--support",
            "hall", "-o", path("plan.json"), config[0], config[1]});
  const std::string results = path("plan/hall/room/");
  {
    RunningCommand first({"run", path("plan.json"), "--jobs", "2"}, path("."), "first");
    for (int i = 0; i < 3000 && !std::filesystem::exists(results + "fuse-1.lock"); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }  // killed
  EXPECT_EQ(run_json({"status", path("plan.json")})["failed"], 0);
  const auto second = run_json({"run", path("plan.json"), "--jobs", "2"});
  EXPECT_EQ(second["were_done"], 1) << "the survey is not repeated: " << second;
  EXPECT_EQ(second["ran"], 3);
  // The last task needs no solve of its own: poses, masks and bodies are those of the survey.
  const std::string log = file("plan/hall/room/build.log");
  EXPECT_EQ(log.find("detecting tags"), std::string::npos) << log;
  EXPECT_EQ(log.find("tracking objects"), std::string::npos) << log;
  run_json({"build", path("room"), "-o", path("alone"), "--tiles", "1", config[0], config[1]});
  EXPECT_EQ(contents(results + "scene"), contents(path("alone")));
}

TEST_F(Tiles, RefuseFilesOfOtherSteps) {
  const auto refused = [](std::vector<std::string> words, const std::string& why) {
    const CommandOutcome outcome = run_pcavr(words);
    EXPECT_EQ(outcome.exit_code, 1);
    // One line; others are progress.
    const std::string& errors = outcome.standard_error;
    const std::size_t line = errors.find("pcavr: ");
    EXPECT_EQ(errors.find("pcavr: ", line + 1), std::string::npos) << errors;
    EXPECT_NE(errors.find(why), std::string::npos) << errors;
  };
  const std::string room = path("room");
  const std::string survey = path("room.survey");
  const std::vector<std::string> fuse{"fuse", room, "--voxel", "0.04", "--survey", survey};
  const auto fuse_with = [&](std::vector<std::string> words) {
    words.insert(words.begin(), fuse.begin(), fuse.end());
    return words;
  };
  run_json({"survey", room, "--voxel", "0.04", "--tiles", "4", "-o", survey});
  run_json(fuse_with({"--part", "1/2", "-o", path("1.tiles")}));
  refused(
      {"fuse", room, "--voxel", "0.05", "--survey", survey, "--part", "1/1", "-o", path("none")},
      "is of other options");
  refused(fuse_with({"--part", "3/2", "-o", path("none")}), "is no part");
  refused(fuse_with({"--part", "2/2", "-o", path("room/recording.yaml"), "--force"}), "room");
  const auto build = [&](const std::string& voxel, std::vector<std::string> files) {
    std::vector<std::string> words{"build", room,       "-o",   path("none"), "--voxel",
                                   voxel,   "--survey", survey, "--fused"};
    words.insert(words.end(), files.begin(), files.end());
    return words;
  };
  // Before any work: no progress is in the way of the one line.
  const CommandOutcome outcome = run_pcavr(build("0.04", {path("1.tiles")}));
  EXPECT_EQ(outcome.error_lines(), 1U) << outcome.standard_error;
  refused(build("0.04", {path("1.tiles")}), "is one of 2 parts");
  refused(build("0.04", {path("1.tiles"), path("1.tiles")}), "is part 1 again");
  refused(build("0.05", {path("1.tiles"), path("1.tiles")}), "is of other options");
  refused(build("0.04", {survey}), "is no file of this step");
  run_json({"survey", room, "--voxel", "0.04", "--tiles", "2", "-o", path("other.survey")});
  std::vector<std::string> of_other = build("0.04", {path("1.tiles"), path("1.tiles")});
  std::replace(of_other.begin(), of_other.end(), survey, path("other.survey"));
  refused(of_other, "was fused from another survey");
  std::string damaged = file("1.tiles");
  damaged[damaged.size() / 2] = static_cast<char>(damaged[damaged.size() / 2] + 1);
  std::ofstream(path("damaged.tiles"), std::ios::binary) << damaged;
  refused(build("0.04", {path("damaged.tiles"), path("1.tiles")}), "is damaged");
  std::vector<std::string> trusting = build("0.04", {path("1.tiles"), path("1.tiles")});
  trusting.push_back("--trust-poses");
  refused(trusting, "is of other options");
  // The survey speaks of the camera, tags and objects that the manifest had.
  const std::string manifest = file("room/recording.yaml");
  std::string other_scale = manifest;
  other_scale.insert(manifest.find("depth_scale: ") + std::string("depth_scale: ").size(), "1");
  std::ofstream(path("room/recording.yaml")) << other_scale;
  refused(build("0.04", {path("1.tiles"), path("1.tiles")}), "is of another recording");
  std::ofstream(path("room/recording.yaml")) << manifest;
  EXPECT_FALSE(std::filesystem::exists(path("none")));
}

// The limit takes the place of a full disk: no file may be larger than 64 kB.
TEST_F(Tiles, LeaveNoPartWhereTheDiskIsFull) {
  const std::string room = path("room");
  const std::string survey = path("full.survey");
  run_json({"survey", room, "--voxel", "0.04", "--tiles", "4", "-o", survey});
  const CommandOutcome outcome = run_pcavr({"fuse", room, "--voxel", "0.04", "--survey", survey,
                                            "--part", "1/1", "-o", path("full.tiles")},
                                           "ulimit -f 128; ");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.standard_error.find("full.tiles: can't be written"), std::string::npos)
      << outcome.standard_error;
  for (const auto& entry : std::filesystem::directory_iterator(path(".")))
    EXPECT_EQ(entry.path().filename().string().find("full.tiles"), std::string::npos) << entry;
}

TEST_F(Tiles, AreNamedWhereTheMemoryIsTooSmall) {
  const CommandOutcome outcome = run_pcavr(
      {"build", path("room"), "-o", path("none"), "--voxel", "0.005", "--max-memory", "0.5"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.standard_error.find("GB at 5 mm"), std::string::npos) << outcome.standard_error;
  const std::size_t voxel = outcome.standard_error.find("--voxel ");
  ASSERT_NE(voxel, std::string::npos) << outcome.standard_error;
  EXPECT_EQ(outcome.standard_error.find("--tiles"), std::string::npos)
      << "a tile of 4 m has all of the room: " << outcome.standard_error;
  EXPECT_FALSE(std::filesystem::exists(path("none")));
  // The voxel that is named does fit.
  const std::string named = outcome.standard_error.substr(voxel + 8, 5);
  EXPECT_EQ(
      run_pcavr({"build", path("room"), "-o", path("coarse"), "--voxel",
                 named.substr(0, named.find_first_not_of("0123456789.")), "--max-memory", "0.5"})
          .exit_code,
      0);
}

TEST_F(Tiles, RefuseSizesThatAreNone) {
  for (const char* size : {"0", "-1", "nan", "many"}) {
    const CommandOutcome outcome =
        run_pcavr({"build", path("room"), "-o", path("none"), "--tiles", size});
    EXPECT_NE(outcome.exit_code, 0) << size;
    EXPECT_EQ(outcome.error_lines(), 1U) << outcome.standard_error;
    EXPECT_FALSE(std::filesystem::exists(path("none")));
  }
}

}  // namespace
}  // namespace pcavr
