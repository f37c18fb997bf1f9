// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "pcavr/core/expected.hpp"
#include "pcavr/geometry/mesh.hpp"

namespace pcavr::model {

/// The triangles of a file as it stores them, node transforms applied: corners unshared where the
/// file or its importer has them so, triangles without area kept. At least one triangle; all
/// coordinates finite.
[[nodiscard]] Expected<TriangleMesh> import_mesh(const std::filesystem::path& file);

}  // namespace pcavr::model
