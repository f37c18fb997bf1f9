// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace pcavr {

/// Corner c of a cube lies at (c & 1, c >> 1 & 1, c >> 2). An edge runs from its corner `from` one
/// step along `axis`.
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

/// Indexed by the mask of corners inside (negative distance). On a face where both diagonals
/// disagree, the inside corners are kept apart; as both cubes at the face decide alike, the surface
/// has no cracks.
[[nodiscard]] const std::array<CubeCase, 256>& marching_cubes_table();

}  // namespace pcavr
