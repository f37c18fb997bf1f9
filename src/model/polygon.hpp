// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "pcavr/geometry/mesh.hpp"

namespace pcavr::model {

/// Cuts a polygon of the mesh's vertices, which need not be convex, into triangles of the same
/// winding and appends them. Fewer than three corners are a point or a line, and left out.
void append_polygon(std::vector<std::uint32_t> corners, TriangleMesh& mesh);

}  // namespace pcavr::model
