// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "pcavr/base/geometry/mesh.hpp"

namespace pcavr {

/// Removes connected components smaller than `min_area` [m^2]. Returns the number of removed
/// components.
std::size_t remove_small_components(TriangleMesh& mesh, double min_area);

}  // namespace pcavr
