// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/geometry/mesh.hpp"

namespace pcavr {

/// The mesh of a CAD body as a viewer should shade it: round surfaces smooth, edges sharp. Where
/// faces meet at more than 30 degrees their common vertices are split, each with its own normal.
[[nodiscard]] TriangleMesh with_sharp_edges(const TriangleMesh& mesh);

}  // namespace pcavr
