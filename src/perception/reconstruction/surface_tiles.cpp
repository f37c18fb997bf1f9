// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/reconstruction/surface_tiles.hpp"

#include <algorithm>

#include "pcavr/base/core/check.hpp"

#include "perception/reconstruction/voxel_block.hpp"

namespace pcavr {
namespace {

static_assert(kTsdfBlockVoxels == kBlockSide);

using Lent = std::pair<GridEdge, std::uint32_t>;

/// All lent vertices by edge, with their indices in the joined mesh.
std::vector<Lent> lent_vertices(const std::vector<SurfaceTile>& tiles) {
  std::vector<Lent> all;
  std::uint32_t first = 0;
  for (const SurfaceTile& tile : tiles) {
    for (const auto& [edge, vertex] : tile.lent) all.emplace_back(edge, first + vertex);
    first += static_cast<std::uint32_t>(tile.mesh.vertices.size());
  }
  std::sort(all.begin(), all.end());
  return all;
}

/// Appends the triangles of a tile whose vertices begin at `first`, and frees them.
void take_triangles(SurfaceTile& tile, std::uint32_t first, const std::vector<Lent>& lent,
                    TriangleMesh& mesh) {
  std::vector<std::uint32_t> borrowed;
  for (const GridEdge& edge : tile.borrowed) {
    const auto found = std::lower_bound(lent.begin(), lent.end(), Lent{edge, 0});
    PCAVR_REQUIRE(found != lent.end() && found->first == edge, edge.x, edge.y, edge.z, edge.axis);
    borrowed.push_back(found->second);
  }
  const auto owned = static_cast<std::uint32_t>(tile.mesh.vertices.size());
  for (const auto& triangle : tile.mesh.triangles) {
    auto& added = mesh.triangles.emplace_back(triangle);
    for (std::uint32_t& v : added) v = v < owned ? v + first : borrowed[v - owned];
  }
  tile.mesh.triangles = {};
}

/// Appends an array of each tile, and frees it before the next one.
template <typename Item>
void take_array(std::vector<SurfaceTile>& tiles, std::vector<Item> TriangleMesh::*array,
                TriangleMesh& mesh) {
  std::size_t count = 0;
  for (const SurfaceTile& tile : tiles) count += (tile.mesh.*array).size();
  (mesh.*array).reserve(count);
  for (SurfaceTile& tile : tiles) {
    std::vector<Item>& items = tile.mesh.*array;
    (mesh.*array).insert((mesh.*array).end(), items.begin(), items.end());
    std::vector<Item>().swap(items);
  }
}

}  // namespace

TriangleMesh joined(std::vector<SurfaceTile> tiles) {
  const std::vector<Lent> lent = lent_vertices(tiles);
  TriangleMesh mesh;
  std::size_t triangles = 0;
  for (const SurfaceTile& tile : tiles) triangles += tile.mesh.triangles.size();
  mesh.triangles.reserve(triangles);
  std::uint32_t first = 0;
  for (SurfaceTile& tile : tiles) {
    take_triangles(tile, first, lent, mesh);
    first += static_cast<std::uint32_t>(tile.mesh.vertices.size());
  }
  take_array(tiles, &TriangleMesh::vertices, mesh);
  take_array(tiles, &TriangleMesh::normals, mesh);
  take_array(tiles, &TriangleMesh::colors, mesh);
  return mesh;
}

}  // namespace pcavr
