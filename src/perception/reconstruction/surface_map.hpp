// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "perception/reconstruction/block_window.hpp"

namespace pcavr {

/// Bit masks of a block's edges with a vertex and of its cubes with triangles. Edges belong to the
/// block of their lower end.
struct SurfaceMap {
  std::array<std::array<std::uint64_t, 8>, 3> edges{};   ///< by axis and z; bit 8 y + x
  std::array<std::array<std::uint16_t, 8>, 3> before{};  ///< number of vertices before that word
  std::array<std::uint64_t, 8> cubes{};
  std::uint32_t vertices = 0;
  std::uint32_t triangles = 0;
  std::uint32_t first_vertex = 0;
  std::uint32_t first_triangle = 0;
};

/// Calls `visit(at, axis, index)` for each vertex of a block, in the order of their indices from
/// `index` on: it lies on the edge from the voxel `at` of the block along the axis.
template <typename Visit>
void for_each_vertex(const SurfaceMap& surface, const Visit& visit) {
  std::uint32_t next = surface.first_vertex;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (int z = 0; z < 8; ++z) {
      for (std::uint64_t left = surface.edges[axis][static_cast<std::size_t>(z)]; left != 0;
           left &= left - 1) {
        const int bit = std::countr_zero(left);
        visit(std::array<int, 3>{bit % 8, bit / 8, z}, axis, next++);
      }
    }
  }
}

/// Signs of the window, one bit per voxel; row and column 0 are voxel -1.
struct SignRows {
  std::array<std::array<std::uint32_t, 10>, 10> inside{};
  std::array<std::array<std::uint32_t, 10>, 10> known{};
  bool has_inside = false;
  bool has_outside = false;

  explicit SignRows(const Window& window) {
    std::uint32_t any_inside = 0;
    std::uint32_t any_outside = 0;
    for (int z = 0; z < 10; ++z) {
      for (int y = 0; y < 10; ++y) {
        std::uint32_t in = 0;
        std::uint32_t is_known = 0;
        for (int x = 0; x < 10; ++x) {
          const std::int16_t value = window(x - 1, y - 1, z - 1);
          in |= static_cast<std::uint32_t>(value < 0) << x;
          is_known |= static_cast<std::uint32_t>(value != kUnknownDistance) << x;
        }
        inside[static_cast<std::size_t>(z)][static_cast<std::size_t>(y)] = in;
        known[static_cast<std::size_t>(z)][static_cast<std::size_t>(y)] = is_known;
        any_inside |= in & is_known;
        any_outside |= ~in & is_known;
      }
    }
    has_inside = any_inside != 0;
    has_outside = any_outside != 0;
  }

  /// Cubes of a row with all corners known and both signs among them.
  [[nodiscard]] std::uint32_t crossed_cubes(std::size_t y, std::size_t z) const {
    const auto& k0 = known[z];
    const auto& k1 = known[z + 1];
    const std::uint32_t all = k0[y] & k0[y + 1] & k1[y] & k1[y + 1];
    const std::uint32_t in_any =
        inside[z][y] | inside[z][y + 1] | inside[z + 1][y] | inside[z + 1][y + 1];
    const std::uint32_t in_all =
        inside[z][y] & inside[z][y + 1] & inside[z + 1][y] & inside[z + 1][y + 1];
    return (all & (all >> 1)) & (in_any | (in_any >> 1)) & ~(in_all & (in_all >> 1)) & 0x1FFU;
  }

  [[nodiscard]] int cube_case(std::size_t x, std::size_t y, std::size_t z) const {
    std::uint32_t corners = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const std::uint32_t pair = (inside[z + (i >> 1)][y + (i & 1)] >> x) & 3U;
      corners |= pair << (2 * i);
    }
    return static_cast<int>(corners);
  }
};

/// Finds a block's vertices and triangles; offsets are not assigned.
[[nodiscard]] SurfaceMap map_surface(const SignRows& signs);

}  // namespace pcavr
