// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// pcavr build by tiles, and within a memory, with the real command on a simulated room.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string>
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
