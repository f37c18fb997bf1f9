// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>

#include "pcavr/base/core/random.hpp"
#include "pcavr/base/geometry/mesh.hpp"

namespace pcavr::test {

/// A square height field of edge 1 m with n x n cells.
inline TriangleMesh height_field(std::uint32_t n,
                                 const std::function<float(float, float)>& height) {
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

inline TriangleMesh flat_square(std::uint32_t n) {
  return height_field(n, [](float, float) { return 0.0F; });
}

/// A box about the origin, outward winding.
inline TriangleMesh box_mesh(const Eigen::Vector3f& size) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3f sign((i & 1) ? 0.5F : -0.5F, (i & 2) ? 0.5F : -0.5F,
                               (i & 4) ? 0.5F : -0.5F);
    mesh.vertices.push_back(sign.cwiseProduct(size));
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// A sphere about the origin from rings of triangles; its vertices lie on the sphere.
inline TriangleMesh sphere_mesh(float radius, int rings) {
  TriangleMesh mesh;
  const int sectors = 2 * rings;
  mesh.vertices.emplace_back(0.0F, 0.0F, radius);
  for (int i = 1; i < rings; ++i) {
    const double polar = std::numbers::pi * i / rings;
    for (int j = 0; j < sectors; ++j) {
      const double azimuth = 2.0 * std::numbers::pi * j / sectors;
      const Eigen::Vector3d direction(std::sin(polar) * std::cos(azimuth),
                                      std::sin(polar) * std::sin(azimuth), std::cos(polar));
      mesh.vertices.push_back((radius * direction).cast<float>());
    }
  }
  mesh.vertices.emplace_back(0.0F, 0.0F, -radius);
  const auto at = [&](int ring, int sector) -> std::uint32_t {
    if (ring == 0) return 0;
    if (ring == rings) return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
    return static_cast<std::uint32_t>(1 + (ring - 1) * sectors + sector % sectors);
  };
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < sectors; ++j) {
      if (i + 1 < rings) mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      if (i > 0) mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

/// Unconnected triangles in the unit cube.
inline TriangleMesh triangle_soup(int count, Random& random) {
  TriangleMesh mesh;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d centre(random.uniform(), random.uniform(), random.uniform());
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d offset(random.normal(), random.normal(), random.normal());
      mesh.vertices.push_back((centre + 0.05 * offset).cast<float>());
    }
    const auto first = static_cast<std::uint32_t>(3 * i);
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

}  // namespace pcavr::test
