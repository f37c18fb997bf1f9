// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>

#include "pcavr/geometry/mesh.hpp"

namespace pcavr::model {

/// One vertex for all that are identical in position, normal and colour; in the order in which
/// they first appear. Vertices that no triangle uses are left out.
[[nodiscard]] TriangleMesh join_equal_vertices(const TriangleMesh& mesh);

/// Without triangles whose area is zero.
[[nodiscard]] TriangleMesh without_empty_triangles(TriangleMesh mesh);

/// Edges where a surface ends or where neighbours are wound against each other.
struct OpenEdges {
  std::size_t count = 0;
  Eigen::Vector3f somewhere = Eigen::Vector3f::Zero();  ///< the middle of one of them
};

/// Closed means: every edge is run through as often in one direction as in the other. Vertices are
/// told apart by index: join them before.
[[nodiscard]] OpenEdges find_open_edges(const TriangleMesh& mesh);

/// Volume [m^3] and its centroid, as the sum of the tetrahedra that the triangles span with the
/// centre of the bounding box; negative where the winding is inward. For closed meshes.
struct MassProperties {
  double volume = 0.0;
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
};
[[nodiscard]] MassProperties mass_properties(const TriangleMesh& mesh);

}  // namespace pcavr::model
