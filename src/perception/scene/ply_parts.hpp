// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/mesh.hpp"

namespace pcavr {

/// Write the bytes of format_ply() in parts, so that they need not be in memory at once.
[[nodiscard]] Expected<void> write_ply(const TriangleMesh& mesh, const std::filesystem::path& file);
[[nodiscard]] Expected<void> write_ply(const PointCloud& cloud, const std::filesystem::path& file);

}  // namespace pcavr
