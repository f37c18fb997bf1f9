// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "pcavr/geometry/mesh.hpp"

namespace pcavr {

/// Fewer triangles by quadric edge collapse [Garland & Heckbert 1997], colours and borders kept.
/// The result has at most `target_triangles`, or as many as can be had within `max_error` [m].
/// A closed mesh stays closed. Deterministic.
[[nodiscard]] TriangleMesh simplified(const TriangleMesh& mesh, std::size_t target_triangles,
                                      double max_error);

/// Drops the vertices that no triangle uses and renumbers the rest, their order kept.
void keep_used_vertices(TriangleMesh& mesh);

}  // namespace pcavr
