// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "model/mesh_repair.hpp"

#include <gtest/gtest.h>

#include "model/meshes.hpp"

namespace pcavr::model {
namespace {

using test::box_mesh;

/// Three vertices of its own for every triangle.
TriangleMesh unshared(const TriangleMesh& mesh) {
  TriangleMesh apart;
  for (const auto& triangle : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(apart.vertices.size());
    for (const std::uint32_t index : triangle) apart.vertices.push_back(mesh.vertices[index]);
    apart.triangles.push_back({first, first + 1, first + 2});
  }
  return apart;
}

TEST(JoinEqualVertices, SharesTheCornersOfABox) {
  const TriangleMesh joined = join_equal_vertices(unshared(box_mesh({1, 2, 3})));
  EXPECT_EQ(joined.vertices.size(), 8U);
  EXPECT_EQ(joined.triangles.size(), 12U);
  EXPECT_EQ(find_open_edges(joined).count, 0U);
  EXPECT_NEAR(signed_volume(joined), 6.0, 1e-12);
}

TEST(JoinEqualVertices, KeepsVerticesOfDifferentColorApart) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {0, 1, 0}, {-1, 0, 0}};
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  mesh.colors = {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {9, 9, 9}, {9, 9, 9}};
  const TriangleMesh joined = join_equal_vertices(mesh);
  EXPECT_EQ(joined.vertices.size(), 5U);  // (0, 0, 0) is shared, (0, 1, 0) is not
  EXPECT_EQ(joined.colors.size(), 5U);
}

TEST(JoinEqualVertices, LeavesOutWhatNoTriangleUses) {
  TriangleMesh mesh = box_mesh({1, 1, 1});
  mesh.vertices.insert(mesh.vertices.begin(), Eigen::Vector3f(7, 7, 7));
  for (auto& triangle : mesh.triangles) {
    for (std::uint32_t& index : triangle) ++index;
  }
  EXPECT_EQ(join_equal_vertices(mesh).vertices.size(), 8U);
}

TEST(WithoutEmptyTriangles, DropsOnlyThoseWithoutArea) {
  TriangleMesh mesh = box_mesh({1, 1, 1});
  mesh.triangles.push_back({1, 1, 4});
  mesh.vertices.emplace_back(0.0F, -0.5F, -0.5F);  // the middle of the edge from 0 to 1
  mesh.triangles.push_back({0, 8, 1});
  EXPECT_EQ(without_empty_triangles(mesh).triangles, box_mesh({1, 1, 1}).triangles);
}

TEST(FindOpenEdges, CountsTheRimOfAHole) {
  TriangleMesh mesh = box_mesh({1, 1, 1});
  mesh.triangles.pop_back();
  EXPECT_EQ(find_open_edges(mesh).count, 3U);
}

TEST(FindOpenEdges, SeesATriangleWoundAgainstItsNeighbours) {
  TriangleMesh mesh = box_mesh({1, 1, 1});
  std::swap(mesh.triangles[4][0], mesh.triangles[4][1]);
  EXPECT_EQ(find_open_edges(mesh).count, 3U);
}

TEST(MassProperties, AreThoseOfABoxWhereverItStands) {
  const TriangleMesh box = box_mesh({0.1F, 0.2F, 0.3F});
  const Eigen::Vector3d place(0.5, -0.25, 2.0);
  const MassProperties properties =
      mass_properties(transformed(Pose::from_translation(place), box));
  EXPECT_NEAR(properties.volume, 0.006, 1e-8);  // float coordinates at 2 m: 1e-7 m
  EXPECT_NEAR((properties.centroid - place).norm(), 0.0, 1e-6);
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
