// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "pcavr/base/geometry/mesh.hpp"

namespace pcavr::test {

/// A surface of 2 m x 2 m around the origin with waves of 3 cm height, of 2 * cells^2 triangles.
inline TriangleMesh wavy_ground(int cells) {
  TriangleMesh mesh;
  for (int i = 0; i <= cells; ++i) {
    for (int k = 0; k <= cells; ++k) {
      const double x = -1.0 + 2.0 * i / cells;
      const double y = -1.0 + 2.0 * k / cells;
      mesh.vertices.emplace_back(
          Eigen::Vector3d(x, y, 0.03 * std::sin(7.0 * x) * std::cos(9.0 * y)).cast<float>());
    }
  }
  const auto at = [&](int i, int k) { return static_cast<std::uint32_t>(i * (cells + 1) + k); };
  for (int i = 0; i < cells; ++i) {
    for (int k = 0; k < cells; ++k) {
      mesh.triangles.push_back({at(i, k), at(i + 1, k), at(i, k + 1)});
      mesh.triangles.push_back({at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)});
    }
  }
  return mesh;
}

}  // namespace pcavr::test
