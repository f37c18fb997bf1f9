// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/model/mesh_simplification.hpp"

#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

#include <gtest/gtest.h>

#include "support/meshes.hpp"

namespace pcavr {
namespace {

TEST(Simplified, KeepsAFlatSheetsOutlineWithAHundredthOfItsTriangles) {
  const TriangleMesh mesh = test::flat_square(40);
  const TriangleMesh simple = simplified(mesh, 32, 0.001);
  EXPECT_LE(simple.triangles.size(), 32U);
  // The border planes preserve the corners; 0.1 % is a millimetre all around.
  EXPECT_NEAR(surface_area(simple), 1.0, 0.001);
  for (const Eigen::Vector3f& p : simple.vertices) EXPECT_NEAR(p.z(), 0.0F, 1e-6F);
}

TEST(Simplified, StaysWithinTheMaximumError) {
  const auto hill = [](float x, float y) { return 0.1F * std::sin(3.0F * x) * std::cos(3.0F * y); };
  const TriangleMesh mesh = test::height_field(60, hill);
  const TriangleMesh simple = simplified(mesh, 0, 0.002);
  EXPECT_LT(simple.triangles.size(), mesh.triangles.size() / 5);
  EXPECT_GT(simple.triangles.size(), 8U);
  // The bound is on the mean over the planes merged; single vertices may lie twice as far.
  for (const Eigen::Vector3f& p : simple.vertices) {
    EXPECT_NEAR(p.z(), hill(p.x(), p.y()), 0.004F);
  }
}

TEST(Simplified, KeepsAColourEdgeOnAFlatSheet) {
  TriangleMesh mesh = test::flat_square(40);
  for (const Eigen::Vector3f& p : mesh.vertices) {
    mesh.colors.push_back(p.x() < 0.5F ? Rgb8{0, 0, 0} : Rgb8{255, 255, 255});
  }
  const TriangleMesh simple = simplified(mesh, 400, 0.001);
  ASSERT_EQ(simple.colors.size(), simple.vertices.size());
  for (std::size_t i = 0; i < simple.vertices.size(); ++i) {
    // One cell is 25 mm.
    const float x = simple.vertices[i].x();
    if (x < 0.47F) {
      EXPECT_LT(simple.colors[i].g, 10);
    }
    if (x > 0.53F) {
      EXPECT_GT(simple.colors[i].g, 245);
    }
  }
}

TEST(SimplifiedInParts, StaysClosedAndWithinTheMaximumError) {
  const TriangleMesh mesh = test::sphere_mesh(1.0F, 60);
  // Parts of 0.3 m: eight along the sphere.
  const TriangleMesh simple = simplified_in_parts(mesh, 400, 0.02, 0.3);
  EXPECT_LE(simple.triangles.size(), 800U);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& t : simple.triangles) {
    for (std::size_t i = 0; i < 3; ++i) ++edges[{t[i], t[(i + 1) % 3]}];
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(edges.count({edge.second, edge.first}), 1U) << "a crack between parts";
  }
  for (const Eigen::Vector3f& p : simple.vertices) EXPECT_NEAR(p.norm(), 1.0F, 0.04F);
}

TEST(SimplifiedInParts, KeepsAFlatSheetsOutline) {
  const TriangleMesh simple = simplified_in_parts(test::flat_square(40), 32, 0.001, 0.26);
  EXPECT_LE(simple.triangles.size(), 32U);
  EXPECT_NEAR(surface_area(simple), 1.0, 0.001);
}

TEST(Simplified, DoesNotChangeASmallMesh) {
  const TriangleMesh mesh = test::flat_square(2);
  EXPECT_EQ(simplified(mesh, 8, 0.01).triangles, mesh.triangles);
  EXPECT_TRUE(simplified(TriangleMesh(), 10, 0.01).triangles.empty());
}

}  // namespace
}  // namespace pcavr
