// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/geometry/mesh.hpp"

namespace pcavr {

/// Drops the vertices that no triangle uses and renumbers the rest, their order kept.
void keep_used_vertices(TriangleMesh& mesh);

}  // namespace pcavr
