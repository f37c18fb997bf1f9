// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "results/export/streamed_tiles.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/results/export/plain_scene.hpp"

#include "export/exported_box.hpp"
#include "support/meshes.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

using nlohmann::json;

json tileset_of(const std::filesystem::path& folder) {
  return json::parse(read_file(folder / "tileset.json").value());
}

/// The rules of 3D Tiles 1.1, section 7 (tileset.json): errors fall towards the leaves, boxes
/// contain their children's centres, each content exists once.
void check_tile(const json& tile, const std::filesystem::path& folder, double parent_error,
                std::set<std::string>& contents) {
  const double error = tile.at("geometricError");
  EXPECT_GE(error, 0.0);
  EXPECT_LE(error, parent_error);
  const std::vector<double> box = tile.at("boundingVolume").at("box");
  ASSERT_EQ(box.size(), 12U);
  if (tile.contains("content")) {
    const std::string uri = tile["content"].at("uri");
    EXPECT_TRUE(contents.insert(uri).second) << uri;
    const auto mesh = read_mesh(folder / uri);
    ASSERT_TRUE(mesh) << mesh.error().to_string();
    for (const Eigen::Vector3f& y_up : mesh->vertices) {
      const Eigen::Vector3f p(y_up.x(), -y_up.z(), y_up.y());  // as viewers of tiles turn it
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_LE(std::abs(p[static_cast<Eigen::Index>(k)] - box[k]), box[3 + 4 * k] + 1e-4) << uri;
      }
    }
  }
  if (!tile.contains("children")) {
    EXPECT_EQ(error, 0.0) << "a leaf";
    return;
  }
  EXPECT_FALSE(tile["children"].empty());
  for (const json& child : tile["children"]) {
    const std::vector<double> inner = child.at("boundingVolume").at("box");
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_LE(std::abs(inner[k] - box[k]) + inner[3 + 4 * k], box[3 + 4 * k] + 1.1e-3);
    }
    check_tile(child, folder, error, contents);
  }
}

std::size_t files_in(const std::filesystem::path& folder) {
  const std::filesystem::directory_iterator files(folder);
  return static_cast<std::size_t>(std::distance(begin(files), end(files)));
}

TEST(StreamedTiles, FollowTheRulesOf3dTiles) {
  const TemporaryFolder folder;
  TriangleMesh scan = test::height_field(
      400, [](float x, float y) { return 0.05F * std::sin(20.0F * x) * std::cos(15.0F * y); });
  compute_vertex_normals(scan);
  scan.colors.assign(scan.vertices.size(), {200, 90, 10});
  const auto triangles = detail::write_streamed_tiles(scan, {}, 0.0025, folder.path());
  ASSERT_TRUE(triangles) << triangles.error().to_string();
  EXPECT_EQ(*triangles, scan.triangles.size());
  const json tileset = tileset_of(folder.path());
  EXPECT_EQ(tileset.at("asset").at("version"), "1.1");
  std::set<std::string> contents;
  check_tile(tileset.at("root"), folder.path(), tileset.at("geometricError"), contents);
  EXPECT_EQ(contents.size(), files_in(folder.path() / "tiles"));
  EXPECT_GT(contents.size(), 4U);
}

TEST(StreamedTiles, HaveTheScanAndTheBodies) {
  const ExportedBox box;
  const auto written = write_plain_scene(box.manifest(), PlainFormat::tiles, box.target());
  ASSERT_TRUE(written) << written.error().to_string();
  EXPECT_EQ(written->file, "tileset.json");
  const auto scan = read_mesh(box.manifest().folder / "mesh.ply");
  ASSERT_TRUE(scan);
  EXPECT_EQ(written->count, scan->triangles.size() + 12U);
  std::set<std::string> contents;
  const json tileset = tileset_of(box.target());
  check_tile(tileset.at("root"), box.target(), tileset.at("geometricError"), contents);
  EXPECT_TRUE(contents.contains("tiles/bodies.glb"));
  EXPECT_TRUE(contents.contains("tiles/r.glb"));
}

}  // namespace
}  // namespace pcavr
