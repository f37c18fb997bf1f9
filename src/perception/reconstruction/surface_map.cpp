// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/reconstruction/surface_map.hpp"

#include "perception/reconstruction/marching_cubes_table.hpp"

namespace pcavr {

Neighbours neighbours_of(const BlockMap& map, std::uint32_t number) {
  const BlockCoordinates& coordinates = map.coordinates(number);
  Neighbours neighbours;
  std::size_t i = 0;
  for (int dz = -1; dz <= 1; ++dz) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const bool is_self = dx == 0 && dy == 0 && dz == 0;
        neighbours[i++] =
            is_self ? number
                    : map.find({coordinates.x + dx, coordinates.y + dy, coordinates.z + dz});
      }
    }
  }
  return neighbours;
}

SurfaceMap map_surface(const SignRows& signs) {
  SurfaceMap map;
  if (!signs.has_inside || !signs.has_outside) return map;
  std::array<std::array<std::uint32_t, 9>, 9> cubes{};
  for (std::size_t z = 0; z < 9; ++z) {
    for (std::size_t y = 0; y < 9; ++y) cubes[z][y] = signs.crossed_cubes(y, z);
  }
  for (std::size_t z = 1; z < 9; ++z) {
    for (std::size_t y = 1; y < 9; ++y) {
      // An edge has a vertex where its ends differ and one of the four cubes around it is crossed.
      const std::uint32_t here = signs.inside[z][y];
      const std::uint32_t around_x =
          cubes[z][y] | cubes[z][y - 1] | cubes[z - 1][y] | cubes[z - 1][y - 1];
      const std::uint32_t below_z = cubes[z][y] | cubes[z - 1][y];
      const std::uint32_t below_y = cubes[z][y] | cubes[z][y - 1];
      const std::array<std::uint32_t, 3> crossed = {
          (here ^ (here >> 1)) & around_x,
          (here ^ signs.inside[z][y + 1]) & (below_z | (below_z << 1)),
          (here ^ signs.inside[z + 1][y]) & (below_y | (below_y << 1))};
      const std::size_t shift = 8 * (y - 1);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        map.edges[axis][z - 1] |= static_cast<std::uint64_t>((crossed[axis] >> 1) & 0xFFU) << shift;
      }
      const std::uint32_t own = (cubes[z][y] >> 1) & 0xFFU;
      map.cubes[z - 1] |= static_cast<std::uint64_t>(own) << shift;
      for (std::uint32_t left = own; left != 0; left &= left - 1) {
        const auto x = static_cast<std::size_t>(std::countr_zero(left)) + 1;
        map.triangles +=
            marching_cubes_table()[static_cast<std::size_t>(signs.cube_case(x, y, z))].triangles;
      }
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t z = 0; z < 8; ++z) {
      map.before[axis][z] = static_cast<std::uint16_t>(map.vertices);
      map.vertices += static_cast<std::uint32_t>(std::popcount(map.edges[axis][z]));
    }
  }
  return map;
}

}  // namespace pcavr
