// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "pcavr/core/expected.hpp"
#include "pcavr/geometry/mesh.hpp"

namespace pcavr::model {

/// The triangles of a file as stored, node transforms applied: vertices may be duplicated, as in
/// the file or by the importer, and degenerate triangles are kept. At least one triangle; all
/// coordinates finite.
[[nodiscard]] Expected<TriangleMesh> import_mesh(const std::filesystem::path& file);

}  // namespace pcavr::model
