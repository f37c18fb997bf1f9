// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "pcavr/base/geometry/mesh.hpp"

namespace pcavr::model {

/// Simplifies a closed mesh without normals and colours to about `max_triangles`: vertex clustering
/// first if the mesh is very large, then edge collapse. More triangles are kept if the rms error
/// would exceed `max_error` [m]. The result is closed. Deterministic.
[[nodiscard]] TriangleMesh simplified_cad(const TriangleMesh& full, std::size_t max_triangles,
                                          double max_error);

/// One-sided Hausdorff distance: the maximum distance [m] from a point of `full` to `simple`,
/// sampled at every vertex and, on large triangles, at points a 256th of the diagonal apart
/// (further if that were more than two million). Rounded up to 0.1 um.
[[nodiscard]] double hausdorff_distance(const TriangleMesh& full, const TriangleMesh& simple);

}  // namespace pcavr::model
