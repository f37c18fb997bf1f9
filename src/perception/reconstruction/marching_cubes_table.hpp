// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace pcavr {

/// Corner c of a cube has the coordinates (c & 1, c >> 1 & 1, c >> 2). An edge goes from corner
/// `from` one step along `axis`.
struct CubeEdge {
  std::uint8_t from = 0;
  std::uint8_t axis = 0;
};

/// The twelve edges: axis x first, then y, then z.
[[nodiscard]] const std::array<CubeEdge, 12>& cube_edges();

/// Triangles of one of the 256 cases, as edges, wound counter-clockwise seen from the outside.
struct CubeCase {
  std::uint16_t edges = 0;  ///< bit e: edge e is crossed
  std::uint8_t triangles = 0;
  std::array<std::array<std::uint8_t, 3>, 5> corners{};
};

/// Marching cubes lookup table, indexed by the mask of corners inside (negative distance). On an
/// ambiguous face (inside corners at a diagonal) the inside corners are separated; both cubes at
/// the face resolve the ambiguity the same way, so that the surface has no cracks.
[[nodiscard]] const std::array<CubeCase, 256>& marching_cubes_table();

}  // namespace pcavr
