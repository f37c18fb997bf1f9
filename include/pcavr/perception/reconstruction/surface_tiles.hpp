// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/mesh.hpp"

namespace pcavr {

inline constexpr int kTsdfBlockVoxels = 8;  ///< along each side of a block of a TsdfVolume

/// Blocks of a TsdfVolume: those with low <= coordinates < high on each axis. The block (x, y, z)
/// begins at the voxel 8 (x, y, z) of base.
struct BlockBox {
  Eigen::Vector3i low = Eigen::Vector3i::Zero();
  Eigen::Vector3i high = Eigen::Vector3i::Zero();

  [[nodiscard]] bool contains(const Eigen::Vector3i& block) const {
    return (block.array() >= low.array()).all() && (block.array() < high.array()).all();
  }
  [[nodiscard]] BlockBox expanded(int blocks) const {
    return {low.array() - blocks, high.array() + blocks};
  }
};

/// The edge of the voxel grid from a voxel along an axis. A mesh has at most one vertex on it.
struct GridEdge {
  int x = 0;
  int y = 0;
  int z = 0;
  int axis = 0;
  auto operator<=>(const GridEdge&) const = default;
};

/// The surface that the blocks of a box own: the vertices on edges that begin in them, and the
/// triangles of the cubes that begin in them. Frame: base.
struct SurfaceTile {
  /// Indices from vertices.size() on are those of `borrowed`.
  TriangleMesh mesh;
  std::vector<GridEdge> borrowed;  ///< edges whose vertices other tiles own
  /// Edges whose vertices other tiles may borrow, with the vertex.
  std::vector<std::pair<GridEdge, std::uint32_t>> lent;
};

/// Joins tiles that together cover a surface into the mesh that one volume would have had, with its
/// vertices and triangles to the bit, in the order of the tiles. Takes little more memory than the
/// mesh: the tiles are consumed. Throws ContractError where a vertex is in none of them.
[[nodiscard]] TriangleMesh joined(std::vector<SurfaceTile> tiles);

}  // namespace pcavr
