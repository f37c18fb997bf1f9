// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/mesh.hpp"

namespace pcavr {

/// A cube of a mesh: its part of the mesh itself where it has no children, else of a coarser one.
struct OctreeTile {
  std::string name;         ///< the root's is "r", a child's has its parent's and a digit 0 to 7
  Eigen::AlignedBox3f box;  ///< of its mesh and of all below
  double error = 0.0;       ///< distance of its mesh from the full one, at most [m]
  std::vector<OctreeTile> children;
};

struct OctreeOptions {
  std::size_t max_triangles = 100'000;  ///< of a tile, unless it is no wider than min_edge
  double min_edge = 0.1;                ///< of the smallest cubes [m]
  /// Mean error of the first level above the full mesh, twice as much for each further one [m].
  double error = 0.005;
};

/// Divides a mesh for viewers that load what they see. Where tiles of one depth or of neighbouring
/// ones meet, their vertices are the same: no cracks. `write` gets each tile's name and mesh,
/// children first; its Error ends the work. One tile and its children are in memory at a time.
/// Deterministic. The mesh must have triangles.
[[nodiscard]] Expected<OctreeTile> divide_mesh(
    const TriangleMesh& mesh, const OctreeOptions& options,
    const std::function<Expected<void>(const std::string& name, const TriangleMesh& mesh)>& write);

}  // namespace pcavr
