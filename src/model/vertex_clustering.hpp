// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/geometry/mesh.hpp"

namespace pcavr::model {

/// Joins all vertices of a grid cell that face the same one of six sides into one, placed where the
/// planes around them fit best [Lindstrom 2000]: linear in the triangles, and in memory. The two
/// sides of a thin wall stay apart. Positions only; a closed mesh stays closed, because a map of
/// vertices maps a surface without border to one without border. `cell` [m] > 0. Deterministic.
[[nodiscard]] TriangleMesh cluster_vertices(const TriangleMesh& mesh, double cell);

}  // namespace pcavr::model
