// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/reconstruction/marching_cubes_table.hpp"

#include <optional>
#include <vector>

namespace pcavr {
namespace {

using Polygon = std::vector<std::uint8_t>;  ///< edges in order

std::uint8_t edge_between(int a, int b) {
  const int low = a < b ? a : b;
  const int axis_bit = a ^ b;
  for (std::uint8_t e = 0; e < 12; ++e) {
    if (cube_edges()[e].from == low && (1 << cube_edges()[e].axis) == axis_bit) return e;
  }
  return 12;
}

/// The corners of the six faces, clockwise seen from outside the cube.
std::array<std::array<int, 4>, 6> cube_faces() {
  std::array<std::array<int, 4>, 6> faces{};
  for (int axis = 0; axis < 3; ++axis) {
    const int n = 1 << axis;
    const int a = 1 << ((axis + 1) % 3);
    const int b = 1 << ((axis + 2) % 3);
    faces[static_cast<std::size_t>(2 * axis)] = {n, n | b, n | a | b, n | a};
    faces[static_cast<std::size_t>(2 * axis + 1)] = {0, a, a | b, b};
  }
  return faces;
}

/// The next crossed edge along the border of the inside region, for each crossed edge. The
/// surface's border, clockwise around a face, runs from the edge where the inside ends to the edge
/// where it began: each run of inside corners is separated, which resolves the face ambiguity of
/// marching cubes.
std::array<std::optional<std::uint8_t>, 12> successors(int inside) {
  std::array<std::optional<std::uint8_t>, 12> next;
  const auto is_inside = [&](int corner) { return (inside >> corner & 1) != 0; };
  for (const std::array<int, 4>& face : cube_faces()) {
    for (std::size_t i = 0; i < 4; ++i) {
      if (is_inside(face[i]) || !is_inside(face[(i + 1) % 4])) continue;
      const std::uint8_t entered = edge_between(face[i], face[(i + 1) % 4]);
      std::size_t j = (i + 1) % 4;
      while (is_inside(face[(j + 1) % 4])) j = (j + 1) % 4;
      next[edge_between(face[j], face[(j + 1) % 4])] = entered;
    }
  }
  return next;
}

std::vector<Polygon> polygons_of(int inside) {
  const auto next = successors(inside);
  std::array<bool, 12> visited{};
  std::vector<Polygon> polygons;
  for (std::uint8_t start = 0; start < 12; ++start) {
    if (!next[start].has_value() || visited[start]) continue;
    Polygon polygon;
    for (std::uint8_t e = start; !visited[e]; e = *next[e]) {
      visited[e] = true;
      polygon.push_back(e);
    }
    polygons.push_back(polygon);
  }
  return polygons;
}

bool lie_on_one_face(std::uint8_t a, std::uint8_t b) {
  const auto has = [](const std::array<int, 4>& face, std::uint8_t e) {
    const CubeEdge edge = cube_edges()[e];
    const int to = edge.from | (1 << edge.axis);
    int found = 0;
    for (const int corner : face) found += corner == edge.from || corner == to ? 1 : 0;
    return found == 2;
  };
  for (const auto& face : cube_faces()) {
    if (has(face, a) && has(face, b)) return true;
  }
  return false;
}

/// Triangulates a polygon by ear clipping with no diagonal on a face of the cube, where the
/// neighbouring cube could have the same one: four triangles would share it (non-manifold).
bool triangulate(const Polygon& polygon, CubeCase& result) {
  if (polygon.size() == 3) {
    result.corners[result.triangles++] = {polygon[0], polygon[1], polygon[2]};
    return true;
  }
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const std::uint8_t before = polygon[(i + polygon.size() - 1) % polygon.size()];
    const std::uint8_t after = polygon[(i + 1) % polygon.size()];
    if (lie_on_one_face(before, after)) continue;
    const CubeCase saved = result;
    result.corners[result.triangles++] = {before, polygon[i], after};
    Polygon rest = polygon;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
    if (triangulate(rest, result)) return true;
    result = saved;
  }
  return false;
}

std::array<CubeCase, 256> make_table() {
  std::array<CubeCase, 256> table;
  for (int inside = 0; inside < 256; ++inside) {
    CubeCase& cube = table[static_cast<std::size_t>(inside)];
    for (const Polygon& polygon : polygons_of(inside)) {
      for (const std::uint8_t e : polygon)
        cube.edges = static_cast<std::uint16_t>(cube.edges | (1U << e));
      triangulate(polygon, cube);
    }
  }
  return table;
}

}  // namespace

const std::array<CubeEdge, 12>& cube_edges() {
  static constexpr std::array<CubeEdge, 12> kEdges = {{{0, 0},
                                                       {2, 0},
                                                       {4, 0},
                                                       {6, 0},
                                                       {0, 1},
                                                       {1, 1},
                                                       {4, 1},
                                                       {5, 1},
                                                       {0, 2},
                                                       {1, 2},
                                                       {2, 2},
                                                       {3, 2}}};
  return kEdges;
}

const std::array<CubeCase, 256>& marching_cubes_table() {
  static const std::array<CubeCase, 256> table = make_table();
  return table;
}

}  // namespace pcavr
