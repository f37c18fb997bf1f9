// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "base/model/polygon.hpp"

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

namespace pcavr::model {
namespace {

/// Triangulates one polygon through all the points, in order.
TriangleMesh triangulate(const std::vector<Eigen::Vector3f>& points) {
  TriangleMesh mesh;
  mesh.vertices = points;
  std::vector<std::uint32_t> corners(points.size());
  std::iota(corners.begin(), corners.end(), 0U);
  append_polygon(corners, mesh);
  return mesh;
}

Eigen::Vector3f normal(const TriangleMesh& mesh, std::size_t i) {
  const auto& [a, b, c] = mesh.triangles[i];
  return (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
}

TEST(AppendPolygon, TriangulatesASquare) {
  const TriangleMesh mesh = triangulate({{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}});
  ASSERT_EQ(mesh.triangles.size(), 2U);
  EXPECT_NEAR(surface_area(mesh), 1.0, 1e-12);
}

// A triangle outside the notch would make the areas' sum larger than the polygon.
TEST(AppendPolygon, StaysInsideANonConvexPolygon) {
  const std::vector<Eigen::Vector3f> arrow = {{1, 0, 0}, {0, -2, 0}, {4, 0, 0}, {0, 2, 0}};
  for (std::ptrdiff_t start = 0; start < 4; ++start) {
    std::vector<Eigen::Vector3f> rotated = arrow;
    std::rotate(rotated.begin(), rotated.begin() + start, rotated.end());
    const TriangleMesh mesh = triangulate(rotated);
    ASSERT_EQ(mesh.triangles.size(), 2U);
    EXPECT_NEAR(surface_area(mesh), 6.0, 1e-12);  // 4 * 4 / 2 without the notch of 4 * 1 / 2
    for (std::size_t i = 0; i < 2; ++i) EXPECT_GT(normal(mesh, i).z(), 0.0F);
  }
}

TEST(AppendPolygon, IgnoresPointsAndLines) {
  EXPECT_TRUE(triangulate({{0, 0, 0}}).triangles.empty());
  EXPECT_TRUE(triangulate({{0, 0, 0}, {1, 0, 0}}).triangles.empty());
}

TEST(AppendPolygon, TerminatesForAPolygonWithoutArea) {
  EXPECT_EQ(triangulate({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 0, 0}}).triangles.size(), 2U);
}

}  // namespace
}  // namespace pcavr::model
