// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "pcavr/geometry/mesh.hpp"

namespace pcavr {

/// Drops connected parts with less than `smallest_area` [m^2]. Returns the number of parts dropped.
std::size_t remove_small_islands(TriangleMesh& mesh, double smallest_area);

/// Fewer triangles by quadric edge collapse [Garland & Heckbert 1997], colours and borders kept.
/// The result has at most `target_triangles`, or as many as can be had within `largest_error` [m].
[[nodiscard]] TriangleMesh simplified(const TriangleMesh& mesh, std::size_t target_triangles,
                                      double largest_error);

}  // namespace pcavr
