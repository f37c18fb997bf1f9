// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/base/geometry/mesh.hpp"

namespace pcavr {

/// A mesh for shading: smooth surfaces with sharp edges (crease angle 30 degrees). Vertices on a
/// sharp edge are split, each with its own unit normal.
[[nodiscard]] TriangleMesh with_sharp_edges(const TriangleMesh& mesh);

}  // namespace pcavr
