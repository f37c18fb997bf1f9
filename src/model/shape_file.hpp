// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

#include "pcavr/core/expected.hpp"
#include "pcavr/geometry/mesh.hpp"

namespace pcavr::model {

/// The shape alone, without normals and colours, of a binary STL, a binary little-endian PLY or an
/// OBJ, read piece by piece: some 40 bytes of memory a triangle where a general importer needs 300
/// and more. Equal corners of an STL are shared, in the order of their first use. Nothing where the
/// file is of another kind, broken, or holds what this reader does not know: import_mesh then
/// decides, and words the error.
[[nodiscard]] std::optional<TriangleMesh> read_shape(const std::filesystem::path& file);

/// What make_cad_model needs of a file: read_shape for large files, import_mesh for all others. At
/// least one triangle; all coordinates finite.
[[nodiscard]] Expected<TriangleMesh> import_shape(const std::filesystem::path& file);

}  // namespace pcavr::model
