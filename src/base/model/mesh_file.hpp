// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/mesh.hpp"

#include "base/model/mesh_readers.hpp"

namespace pcavr::model {

/// The triangles of a file as stored, node transforms applied: vertices may be duplicated, as in
/// the file or by its reader, and degenerate triangles are kept. At least one triangle; all
/// coordinates of their corners finite. `content`: kShape gives no normals and colours.
[[nodiscard]] Expected<TriangleMesh> import_mesh(const std::filesystem::path& file,
                                                 MeshContent content);

}  // namespace pcavr::model
