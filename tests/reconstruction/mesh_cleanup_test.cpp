// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/reconstruction/mesh_cleanup.hpp"

#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

#include "support/meshes.hpp"

namespace pcavr {
namespace {

TEST(RemoveSmallComponents, RemovesComponentsBelowTheArea) {
  TriangleMesh mesh = test::flat_square(4);
  const std::size_t vertices = mesh.vertices.size();
  const std::size_t triangles = mesh.triangles.size();
  const auto first = static_cast<std::uint32_t>(vertices);
  mesh.vertices.insert(mesh.vertices.begin() + static_cast<std::ptrdiff_t>(vertices),
                       {{2.0F, 0.0F, 0.0F}, {2.1F, 0.0F, 0.0F}, {2.0F, 0.1F, 0.0F}});
  mesh.triangles.push_back({first, first + 1, first + 2});
  EXPECT_EQ(remove_small_components(mesh, 0.01), 1U);
  EXPECT_EQ(mesh.vertices.size(), vertices);
  EXPECT_EQ(mesh.triangles.size(), triangles);
  EXPECT_EQ(remove_small_components(mesh, 2.0), 1U);
  EXPECT_TRUE(mesh.vertices.empty());
  EXPECT_EQ(remove_small_components(mesh, 1.0), 0U);
}

TEST(RemoveSmallComponents, KeepsThoseOfAtLeastTheAreaInAnyOrderOfTriangles) {
  Random random(71);
  for (int trial = 0; trial < 50; ++trial) {
    // Strips of random lengths; each square has an area of 1e-4 m^2 (float rounding: 1e-6 of it).
    TriangleMesh mesh;
    std::size_t small = 0;
    std::size_t kept_triangles = 0;
    std::size_t kept_vertices = 0;
    const std::size_t min_squares = 1 + random.below(10);
    for (int strip = 0; strip < 20; ++strip) {
      const std::size_t squares = 1 + random.below(20);
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      for (std::uint32_t i = 0; i <= squares; ++i) {
        const float x = 0.01F * static_cast<float>(i);
        mesh.vertices.emplace_back(x, 0.1F * static_cast<float>(strip), 0.0F);
        mesh.vertices.emplace_back(x, 0.1F * static_cast<float>(strip) + 0.01F, 0.0F);
      }
      for (std::uint32_t i = 0; i < squares; ++i) {
        const std::uint32_t a = first + 2 * i;
        mesh.triangles.push_back({a, a + 2, a + 1});
        mesh.triangles.push_back({a + 1, a + 2, a + 3});
      }
      const bool is_small = squares < min_squares;
      small += is_small ? 1 : 0;
      kept_triangles += is_small ? 0 : 2 * squares;
      kept_vertices += is_small ? 0 : 2 * (squares + 1);
    }
    for (std::size_t i = mesh.triangles.size() - 1; i > 0; --i) {
      std::swap(mesh.triangles[i], mesh.triangles[random.below(i + 1)]);
    }
    const double min_area = 1e-4 * (static_cast<double>(min_squares) - 0.5);
    EXPECT_EQ(remove_small_components(mesh, min_area), small);
    EXPECT_EQ(mesh.triangles.size(), kept_triangles);
    EXPECT_EQ(mesh.vertices.size(), kept_vertices);
    for (const auto& t : mesh.triangles) {
      for (const std::uint32_t v : t) ASSERT_LT(v, mesh.vertices.size());
    }
    EXPECT_EQ(remove_small_components(mesh, min_area), 0U);
  }
}

}  // namespace
}  // namespace pcavr
