// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "pcavr/base/geometry/mesh.hpp"

namespace pcavr::model {

/// Welds vertices that are identical in position, normal and colour; in the order in which they
/// first appear. Removes unused vertices.
[[nodiscard]] TriangleMesh weld_vertices(const TriangleMesh& mesh);

/// Removes triangles whose area is zero.
[[nodiscard]] TriangleMesh without_degenerate_triangles(TriangleMesh mesh);

/// Boundary edges of a surface, and edges between neighbours of opposite winding.
struct OpenEdges {
  std::size_t count = 0;
  Eigen::Vector3f location = Eigen::Vector3f::Zero();  ///< the midpoint of one of them
};

/// A mesh is closed (watertight) if every edge is used as often in one direction as in the other.
/// Vertices are compared by index: weld them before.
[[nodiscard]] OpenEdges find_open_edges(const TriangleMesh& mesh);

/// Whether each vertex is on an open edge.
[[nodiscard]] std::vector<bool> vertices_of_open_edges(const TriangleMesh& mesh);

/// Volume [m^3] and its centroid, as the sum of the tetrahedra formed by the triangles and the
/// centre of the bounding box; negative if the winding is inward. For closed meshes.
struct MassProperties {
  double volume = 0.0;
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
};
[[nodiscard]] MassProperties mass_properties(const TriangleMesh& mesh);

}  // namespace pcavr::model
