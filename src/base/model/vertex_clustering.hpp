// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/base/geometry/mesh.hpp"

namespace pcavr::model {

/// Vertex clustering: merges all vertices of a grid cell whose normals have the same dominant axis
/// and sign into one, at the position of minimum quadric error [Lindstrom 2000]. Linear in time and
/// memory. The two sides of a thin wall stay apart. Positions only; a closed mesh stays closed,
/// because a vertex map takes a surface without boundary to one without boundary. `cell` [m] > 0.
/// Deterministic.
[[nodiscard]] TriangleMesh cluster_vertices(const TriangleMesh& mesh, double cell);

}  // namespace pcavr::model
