// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/model/mesh_octree.hpp"

#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "support/meshes.hpp"

namespace pcavr {
namespace {

constexpr OctreeOptions kOctree{.max_triangles = 1500, .min_edge = 0.05, .error = 0.001};

struct DividedSphere {
  TriangleMesh full = test::sphere_mesh(1.0F, 120);
  std::map<std::string, TriangleMesh> meshes = {};
  OctreeTile root = {};

  DividedSphere() {
    root = divide_mesh(full, kOctree,
                       [&](const std::string& name, const TriangleMesh& mesh) -> Expected<void> {
                         EXPECT_TRUE(meshes.emplace(name, mesh).second) << name;
                         return {};
                       })
               .value();
  }
};

/// The tiles that a viewer shows which goes on into those with `is_near`.
void cut(const OctreeTile& tile, const std::function<bool(const OctreeTile&)>& is_near,
         std::vector<const OctreeTile*>& shown) {
  if (tile.children.empty() || !is_near(tile)) {
    shown.push_back(&tile);
    return;
  }
  for (const OctreeTile& child : tile.children) cut(child, is_near, shown);
}

using Point = std::array<float, 3>;

/// How many edges of the tiles together have no neighbour of exactly the same ends.
std::size_t open_edges(const DividedSphere& sphere, const std::vector<const OctreeTile*>& shown) {
  std::map<std::pair<Point, Point>, int> edges;
  for (const OctreeTile* tile : shown) {
    const TriangleMesh& mesh = sphere.meshes.at(tile->name);
    for (const auto& t : mesh.triangles) {
      const auto point = [&](std::size_t i) {
        const Eigen::Vector3f& p = mesh.vertices[t[i % 3]];
        return Point{p.x(), p.y(), p.z()};
      };
      for (std::size_t i = 0; i < 3; ++i) ++edges[{point(i), point(i + 1)}];
    }
  }
  std::size_t open = 0;
  for (const auto& [edge, count] : edges) {
    open += count != 1 || !edges.contains({edge.second, edge.first}) ? 1 : 0;
  }
  return open;
}

void for_each_tile(const OctreeTile& tile, const std::function<void(const OctreeTile&)>& visit) {
  visit(tile);
  for (const OctreeTile& child : tile.children) for_each_tile(child, visit);
}

TEST(DivideMesh, HasTheWholeMeshInItsLeaves) {
  const DividedSphere sphere;
  std::size_t triangles = 0;
  std::size_t inner = 0;
  for_each_tile(sphere.root, [&](const OctreeTile& tile) {
    const TriangleMesh& mesh = sphere.meshes.at(tile.name);
    EXPECT_FALSE(mesh.triangles.empty()) << tile.name;
    if (tile.children.empty()) {
      EXPECT_EQ(tile.error, 0.0);
      EXPECT_LE(mesh.triangles.size(), kOctree.max_triangles);
      triangles += mesh.triangles.size();
    } else {
      ++inner;
    }
    for (const Eigen::Vector3f& p : mesh.vertices) EXPECT_TRUE(tile.box.contains(p)) << tile.name;
    for (const OctreeTile& child : tile.children) {
      EXPECT_TRUE(tile.box.contains(child.box)) << child.name;
      EXPECT_GT(tile.error, child.error) << child.name;
    }
  });
  EXPECT_EQ(triangles, sphere.full.triangles.size());
  EXPECT_GT(inner, 2U);
}

TEST(DivideMesh, StaysWithinItsErrors) {
  const DividedSphere sphere;
  // The chords of the full mesh: 1 - cos(pi / 240).
  for_each_tile(sphere.root, [&](const OctreeTile& tile) {
    for (const Eigen::Vector3f& p : sphere.meshes.at(tile.name).vertices) {
      EXPECT_NEAR(p.norm(), 1.0F, tile.error + 2e-4) << tile.name;
    }
  });
  EXPECT_LT(sphere.meshes.at("r").triangles.size(), sphere.full.triangles.size() / 3);
}

TEST(DivideMesh, HasNoCracksBetweenTilesOfDifferentDepth) {
  const DividedSphere sphere;
  const std::function<bool(const OctreeTile&)> cuts[] = {
      [](const OctreeTile&) { return true; }, [](const OctreeTile&) { return false; },
      [](const OctreeTile& tile) { return tile.box.max().x() > 0.5F; },
      [](const OctreeTile& tile) { return tile.box.contains(Eigen::Vector3f(0.0F, 0.6F, 0.8F)); }};
  std::set<std::size_t> sizes;
  for (const auto& is_near : cuts) {
    std::vector<const OctreeTile*> shown;
    cut(sphere.root, is_near, shown);
    sizes.insert(shown.size());
    EXPECT_EQ(open_edges(sphere, shown), 0U) << shown.size() << " tiles";
  }
  EXPECT_EQ(sizes.size(), std::size(cuts)) << "the cuts are the same";
}

TEST(DivideMesh, EndsWithTheErrorOfItsWriter) {
  int written = 0;
  const Expected<OctreeTile> root =
      divide_mesh(test::sphere_mesh(1.0F, 60), kOctree,
                  [&](const std::string& name, const TriangleMesh&) -> Expected<void> {
                    if (++written == 2) return Error{.message = "the disk is full", .file = name};
                    return {};
                  });
  ASSERT_FALSE(root);
  EXPECT_EQ(root.error().message, "the disk is full");
  EXPECT_EQ(written, 2);
}

TEST(DivideMesh, DividesAMeshThatIsWiderThanAllCells) {
  TriangleMesh mesh = test::flat_square(60);
  for (Eigen::Vector3f& p : mesh.vertices) p *= 1e4F;
  std::size_t leaves = 0;
  const auto root =
      divide_mesh(mesh, {.max_triangles = 100, .min_edge = 0.01, .error = 0.01},
                  [&](const std::string&, const TriangleMesh&) -> Expected<void> { return {}; });
  ASSERT_TRUE(root);
  for_each_tile(*root, [&](const OctreeTile& tile) { leaves += tile.children.empty() ? 1 : 0; });
  EXPECT_GT(leaves, 50U);
}

}  // namespace
}  // namespace pcavr
