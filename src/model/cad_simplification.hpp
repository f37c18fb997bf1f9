// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "pcavr/geometry/mesh.hpp"

namespace pcavr::model {

/// A closed mesh with about `max_triangles` that stands in for `full`, which is closed, without
/// normals and colours: first by clusters of vertices where the mesh is very large, then by edge
/// collapses. More triangles are kept where fewer would leave the surface too far. Deterministic.
[[nodiscard]] TriangleMesh simplified_cad(const TriangleMesh& full, std::size_t max_triangles);

/// The largest distance [m] from a point of `full` to `simple`: measured at every vertex and, on
/// triangles larger than that, at points a 256th of the diagonal apart (further where that would be
/// more than two million). Rounded up to 0.1 um.
[[nodiscard]] double max_deviation(const TriangleMesh& full, const TriangleMesh& simple);

}  // namespace pcavr::model
