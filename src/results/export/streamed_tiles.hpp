// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/mesh.hpp"

namespace pcavr::detail {

inline constexpr char kTilesetFile[] = "tileset.json";

/// Writes a scan and bodies [base] as 3D Tiles 1.1 [OGC 22-025r4]: tileset.json and tiles/*.glb.
/// The scan is an octree of tiles that replace their parents where a viewer is near; the errors
/// that it decides by are those of their simplification. `voxel_size` [m] is the scan's. One of the
/// two may be empty. Returns the triangles of the finest level.
[[nodiscard]] Expected<std::size_t> write_streamed_tiles(const TriangleMesh& scan,
                                                         const TriangleMesh& bodies,
                                                         double voxel_size,
                                                         const std::filesystem::path& folder);

}  // namespace pcavr::detail
