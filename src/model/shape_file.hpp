// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

#include "pcavr/core/expected.hpp"
#include "pcavr/geometry/mesh.hpp"

namespace pcavr::model {

/// Streaming reader of the shape alone, without normals and colours, of a binary STL, a binary
/// little-endian PLY or an OBJ: some 40 bytes of memory per triangle, where assimp needs 300 and
/// more. Equal corners of an STL are welded, in the order of their first use. Nothing if the file
/// is of another type, corrupt, or not supported by this reader: then use import_mesh, which also
/// reports the error.
[[nodiscard]] std::optional<TriangleMesh> read_shape(const std::filesystem::path& file);

/// The shape of a file for a CAD model: read_shape for large files, import_mesh for all others. At
/// least one triangle; all coordinates finite.
[[nodiscard]] Expected<TriangleMesh> import_shape(const std::filesystem::path& file);

}  // namespace pcavr::model
