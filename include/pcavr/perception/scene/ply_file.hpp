// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/mesh.hpp"

namespace pcavr {

/// The bytes of a PLY file (binary, little endian) with the property names that PCL, Open3D and
/// MeshLab expect: x y z, nx ny nz and red green blue where there are normals and colours.
[[nodiscard]] std::string format_ply(const TriangleMesh& mesh);
[[nodiscard]] std::string format_ply(const PointCloud& cloud);

/// Reads what format_ply writes; anything else, a truncated file or indices out of range are
/// Errors. A point cloud is a mesh without triangles.
[[nodiscard]] Expected<TriangleMesh> read_ply(const std::filesystem::path& file);

}  // namespace pcavr
