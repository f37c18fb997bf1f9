// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "pcavr/base/geometry/mesh.hpp"

namespace pcavr {

/// The bytes of a glTF file (.glb) with one mesh, y up: a scan with its colours, or a body as
/// viewers light it. The mesh must have triangles.
[[nodiscard]] std::string format_single_glb(const std::string& name, const TriangleMesh& mesh_base,
                                            bool is_scanned);

}  // namespace pcavr
