// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/geometry/mesh.hpp"

#include <cmath>
#include <utility>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

/// A tetrahedron with edges a along the axes, at the origin: volume a^3 / 6.
TriangleMesh tetrahedron(float a) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {a, 0, 0}, {0, a, 0}, {0, 0, a}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return mesh;
}

TEST(TriangleMesh, HasVolumeAndArea) {
  EXPECT_NEAR(signed_volume(tetrahedron(2)), 8.0 / 6.0, 1e-12);
  EXPECT_NEAR(surface_area(tetrahedron(2)), 6.0 + 2.0 * std::sqrt(3.0), 1e-12);
}

TEST(TriangleMesh, InsideOutHasNegativeVolume) {
  TriangleMesh mesh = tetrahedron(2);
  for (auto& triangle : mesh.triangles) std::swap(triangle[0], triangle[1]);
  EXPECT_NEAR(signed_volume(mesh), -8.0 / 6.0, 1e-12);
}

TEST(TriangleMesh, KeepsVolumeAndNormalsWhenTransformed) {
  TriangleMesh mesh_b = tetrahedron(1);
  compute_vertex_normals(mesh_b);
  Vector6d twist;
  twist << 1, 2, 3, 0.4, 0.5, 0.6;
  const Pose T_a_b = Pose::exp(twist);
  TriangleMesh mesh_a = transformed(T_a_b, mesh_b);
  EXPECT_NEAR(signed_volume(mesh_a), 1.0 / 6.0, 1e-6);  // float vertices
  const std::vector<Eigen::Vector3f> rotated_normals = mesh_a.normals;
  compute_vertex_normals(mesh_a);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_LT((rotated_normals[i] - mesh_a.normals[i]).norm(), 1e-5f);
}

TEST(VertexNormals, OfAFlatPatchPointUp) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {5, 5, 5}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  compute_vertex_normals(mesh);
  for (const Eigen::Vector3f& normal : mesh.normals) EXPECT_EQ(normal, Eigen::Vector3f(0, 0, 1));
}

TEST(Bounds, OfNothingAreEmpty) {
  EXPECT_TRUE(bounds({}).isEmpty());
  EXPECT_EQ(bounds({{1, 2, 3}, {-1, 5, 0}}).max(), Eigen::Vector3f(1, 5, 3));
}

TEST(Plane, MeasuresAlongItsNormal) {
  const Plane plane{{0, 0, 1}, 0.5};
  EXPECT_EQ(plane.signed_distance({3, 4, 2}), 1.5);
  EXPECT_EQ(plane.signed_distance({0, 0, 0}), -0.5);
}

}  // namespace
}  // namespace pcavr
