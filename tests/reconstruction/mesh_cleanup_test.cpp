// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/reconstruction/mesh_cleanup.hpp"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

/// A square height field of 1 m edge with n x n cells.
TriangleMesh height_field(std::uint32_t n, const std::function<float(float, float)>& height) {
  TriangleMesh mesh;
  for (std::uint32_t y = 0; y <= n; ++y) {
    for (std::uint32_t x = 0; x <= n; ++x) {
      const float px = static_cast<float>(x) / static_cast<float>(n);
      const float py = static_cast<float>(y) / static_cast<float>(n);
      mesh.vertices.emplace_back(px, py, height(px, py));
    }
  }
  for (std::uint32_t y = 0; y < n; ++y) {
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t a = y * (n + 1) + x;
      mesh.triangles.push_back({a, a + 1, a + n + 2});
      mesh.triangles.push_back({a, a + n + 2, a + n + 1});
    }
  }
  return mesh;
}

TriangleMesh flat_square(std::uint32_t n) {
  return height_field(n, [](float, float) { return 0.0F; });
}

TEST(RemoveSmallComponents, RemovesComponentsBelowTheArea) {
  TriangleMesh mesh = flat_square(4);
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

}  // namespace
}  // namespace pcavr
