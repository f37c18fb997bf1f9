// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "pcavr/base/geometry/mesh.hpp"

namespace pcavr {

/// Mesh decimation by quadric edge collapse [Garland & Heckbert 1997], preserving colours and
/// borders. The result has at most `target_triangles`, or more if `max_error` [m] requires them.
/// A closed mesh stays closed. Deterministic.
[[nodiscard]] TriangleMesh simplified(const TriangleMesh& mesh, std::size_t target_triangles,
                                      double max_error);

/// The same for meshes that are too large for it: 150 bytes a triangle. It is done in cubes of
/// `part_edge` [m], whose common vertices stay, down to four times the target, then in one: each by
/// half of the error. A closed mesh stays closed. Deterministic.
[[nodiscard]] TriangleMesh simplified_in_parts(const TriangleMesh& mesh,
                                               std::size_t target_triangles, double max_error,
                                               double part_edge);

/// Removes the vertices that no triangle references and reindexes the rest in their order.
void remove_unused_vertices(TriangleMesh& mesh);

}  // namespace pcavr
