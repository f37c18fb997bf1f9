// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "model/polygon.hpp"

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

namespace pcavr::model {
namespace {

/// One polygon through all the points, in order.
TriangleMesh cut_up(const std::vector<Eigen::Vector3f>& points) {
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

TEST(AppendPolygon, CutsASquareInTwo) {
  const TriangleMesh mesh = cut_up({{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}});
  ASSERT_EQ(mesh.triangles.size(), 2U);
  EXPECT_NEAR(surface_area(mesh), 1.0, 1e-12);
}

// A triangle outside the notch would make the areas' sum larger than the polygon.
TEST(AppendPolygon, StaysInsideAShapeThatIsNotConvex) {
  const std::vector<Eigen::Vector3f> arrow = {{1, 0, 0}, {0, -2, 0}, {4, 0, 0}, {0, 2, 0}};
  for (std::ptrdiff_t start = 0; start < 4; ++start) {
    std::vector<Eigen::Vector3f> turned = arrow;
    std::rotate(turned.begin(), turned.begin() + start, turned.end());
    const TriangleMesh mesh = cut_up(turned);
    ASSERT_EQ(mesh.triangles.size(), 2U);
    EXPECT_NEAR(surface_area(mesh), 6.0, 1e-12);  // 4 * 4 / 2 without the notch of 4 * 1 / 2
    for (std::size_t i = 0; i < 2; ++i) EXPECT_GT(normal(mesh, i).z(), 0.0F);
  }
}

TEST(AppendPolygon, LeavesOutPointsAndLines) {
  EXPECT_TRUE(cut_up({{0, 0, 0}}).triangles.empty());
  EXPECT_TRUE(cut_up({{0, 0, 0}, {1, 0, 0}}).triangles.empty());
}

TEST(AppendPolygon, EndsWhereAPolygonHasNoArea) {
  EXPECT_EQ(cut_up({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 0, 0}}).triangles.size(), 2U);
}

}  // namespace
}  // namespace pcavr::model
