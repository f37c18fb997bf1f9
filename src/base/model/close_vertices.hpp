// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/base/geometry/mesh.hpp"

namespace pcavr::model {

/// Closes the seams of a surface whose corners were rounded differently from triangle to triangle:
/// vertices of open edges that are closer than some rounding errors become the first of them. The
/// tolerance grows from the rounding of single precision to 3e-6 of the longest side, and ends
/// where the surface is closed. All other vertices stay, so thin features do, too; a surface that
/// can't be closed so is returned as given. `welded`: from weld_vertices.
[[nodiscard]] TriangleMesh with_closed_seams(const TriangleMesh& welded);

}  // namespace pcavr::model
