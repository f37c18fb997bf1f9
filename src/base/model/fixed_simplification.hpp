// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "pcavr/base/geometry/mesh.hpp"

namespace pcavr {

/// As simplified(), but no vertex with is_fixed moves, and all keep their indices: those that no
/// triangle uses any more remain.
[[nodiscard]] TriangleMesh simplified_between(TriangleMesh mesh, std::vector<bool> is_fixed,
                                              std::size_t target_triangles, double max_error);

}  // namespace pcavr
