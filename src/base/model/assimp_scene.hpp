// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "pcavr/base/geometry/mesh.hpp"

namespace pcavr::model {

/// The triangles of a file that assimp reads, node transforms applied; of its scene, cameras,
/// lights, materials, points and lines are ignored. Throws MeshFault. On a hostile file, assimp may
/// crash, not end, or take all memory: see read_foreign_mesh.
[[nodiscard]] TriangleMesh read_assimp_scene(const std::filesystem::path& file);

}  // namespace pcavr::model
