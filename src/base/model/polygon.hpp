// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "pcavr/base/geometry/mesh.hpp"

namespace pcavr::model {

/// Triangulates a polygon of the mesh's vertices, which need not be convex, by ear clipping and
/// appends the triangles, of the same winding. Fewer than three corners are ignored.
void append_polygon(std::vector<std::uint32_t> corners, TriangleMesh& mesh);

}  // namespace pcavr::model
