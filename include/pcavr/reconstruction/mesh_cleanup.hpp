// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "pcavr/geometry/mesh.hpp"

namespace pcavr {

/// Drops connected parts with less than `min_area` [m^2]. Returns the number of parts dropped.
std::size_t remove_small_islands(TriangleMesh& mesh, double min_area);

}  // namespace pcavr
