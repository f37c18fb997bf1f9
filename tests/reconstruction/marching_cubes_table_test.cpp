// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/reconstruction/marching_cubes_table.hpp"

#include <map>
#include <utility>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

bool lie_on_one_face(std::uint8_t a, std::uint8_t b) {
  const auto corners = [](std::uint8_t e) {
    const CubeEdge edge = cube_edges()[e];
    return std::pair<int, int>(edge.from, edge.from | (1 << edge.axis));
  };
  const auto [a0, a1] = corners(a);
  const auto [b0, b1] = corners(b);
  for (int axis = 0; axis < 3; ++axis) {
    const auto side = [&](int corner) { return corner >> axis & 1; };
    if (side(a0) == side(a1) && side(b0) == side(b1) && side(a0) == side(b0)) return true;
  }
  return false;
}

// Every triangle edge is either shared with another triangle, or lies in a face, where the
// neighbouring cube continues the surface.
TEST(MarchingCubesTable, HasNoBorderInsideACube) {
  for (const CubeCase& cube : marching_cubes_table()) {
    std::map<std::pair<int, int>, int> borders;
    for (std::size_t t = 0; t < cube.triangles; ++t) {
      for (std::size_t i = 0; i < 3; ++i) {
        ++borders[{cube.corners[t][i], cube.corners[t][(i + 1) % 3]}];
      }
    }
    for (const auto& [border, count] : borders) {
      EXPECT_EQ(count, 1);
      const bool is_inner = borders.count({border.second, border.first}) == 1;
      const bool is_on_face = lie_on_one_face(static_cast<std::uint8_t>(border.first),
                                              static_cast<std::uint8_t>(border.second));
      EXPECT_NE(is_inner, is_on_face);
    }
  }
}

TEST(MarchingCubesTable, CrossesExactlyTheEdgesWhoseEndsDiffer) {
  for (int inside = 0; inside < 256; ++inside) {
    unsigned crossed = 0;
    for (std::size_t e = 0; e < 12; ++e) {
      const CubeEdge edge = cube_edges()[e];
      const int to = edge.from | (1 << edge.axis);
      if (((inside >> edge.from) & 1) != ((inside >> to) & 1)) crossed |= 1U << e;
    }
    const CubeCase& cube = marching_cubes_table()[static_cast<std::size_t>(inside)];
    EXPECT_EQ(cube.edges, crossed);
    unsigned used = 0;
    for (std::size_t t = 0; t < cube.triangles; ++t) {
      for (const std::uint8_t e : cube.corners[t]) used |= 1U << e;
    }
    EXPECT_EQ(used, crossed);
  }
}

}  // namespace
}  // namespace pcavr
