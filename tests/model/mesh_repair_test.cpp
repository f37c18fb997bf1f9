// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "base/model/mesh_repair.hpp"

#include <gtest/gtest.h>

#include "support/meshes.hpp"

namespace pcavr::model {
namespace {

using test::box_mesh;

/// Three separate vertices for every triangle.
TriangleMesh unshared(const TriangleMesh& mesh) {
  TriangleMesh separate;
  for (const auto& triangle : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(separate.vertices.size());
    for (const std::uint32_t index : triangle) separate.vertices.push_back(mesh.vertices[index]);
    separate.triangles.push_back({first, first + 1, first + 2});
  }
  return separate;
}

TEST(WeldVertices, SharesTheCornersOfABox) {
  const TriangleMesh welded = weld_vertices(unshared(box_mesh({1, 2, 3})));
  EXPECT_EQ(welded.vertices.size(), 8U);
  EXPECT_EQ(welded.triangles.size(), 12U);
  EXPECT_EQ(find_open_edges(welded).count, 0U);
  EXPECT_NEAR(signed_volume(welded), 6.0, 1e-12);
}

TEST(WeldVertices, KeepsVerticesOfDifferentColorApart) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {0, 1, 0}, {-1, 0, 0}};
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  mesh.colors = {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {9, 9, 9}, {9, 9, 9}};
  const TriangleMesh welded = weld_vertices(mesh);
  EXPECT_EQ(welded.vertices.size(), 5U);  // (0, 0, 0) is shared, (0, 1, 0) is not
  EXPECT_EQ(welded.colors.size(), 5U);
}

TEST(WeldVertices, RemovesUnusedVertices) {
  TriangleMesh mesh = box_mesh({1, 1, 1});
  mesh.vertices.insert(mesh.vertices.begin(), Eigen::Vector3f(7, 7, 7));
  for (auto& triangle : mesh.triangles) {
    for (std::uint32_t& index : triangle) ++index;
  }
  EXPECT_EQ(weld_vertices(mesh).vertices.size(), 8U);
}

TEST(WithoutDegenerateTriangles, RemovesOnlyThoseWithoutArea) {
  TriangleMesh mesh = box_mesh({1, 1, 1});
  mesh.triangles.push_back({1, 1, 4});
  mesh.vertices.emplace_back(0.0F, -0.5F, -0.5F);  // the middle of the edge from 0 to 1
  mesh.triangles.push_back({0, 8, 1});
  EXPECT_EQ(without_degenerate_triangles(mesh).triangles, box_mesh({1, 1, 1}).triangles);
}

TEST(FindOpenEdges, CountsTheBoundaryOfAHole) {
  TriangleMesh mesh = box_mesh({1, 1, 1});
  mesh.triangles.pop_back();
  EXPECT_EQ(find_open_edges(mesh).count, 3U);
}

TEST(FindOpenEdges, FindsATriangleOfOppositeWinding) {
  TriangleMesh mesh = box_mesh({1, 1, 1});
  std::swap(mesh.triangles[4][0], mesh.triangles[4][1]);
  EXPECT_EQ(find_open_edges(mesh).count, 3U);
}

TEST(MassProperties, AreThoseOfABoxAtAnyPosition) {
  const TriangleMesh box = box_mesh({0.1F, 0.2F, 0.3F});
  const Eigen::Vector3d position(0.5, -0.25, 2.0);
  const MassProperties properties =
      mass_properties(transformed(Pose::from_translation(position), box));
  EXPECT_NEAR(properties.volume, 0.006, 1e-8);  // float coordinates at 2 m: 1e-7 m
  EXPECT_NEAR((properties.centroid - position).norm(), 0.0, 1e-6);
}

// A corner of a cube cut off by the plane through its three neighbours: a sixth of the volume,
// the centroid a quarter of the edge from the corner.
TEST(MassProperties, AreThoseOfATetrahedron) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  const MassProperties properties = mass_properties(mesh);
  EXPECT_NEAR(properties.volume, 1.0 / 6.0, 1e-15);
  EXPECT_NEAR((properties.centroid - Eigen::Vector3d(0.25, 0.25, 0.25)).norm(), 0.0, 1e-15);
}

}  // namespace
}  // namespace pcavr::model
