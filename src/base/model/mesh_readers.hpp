// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "pcavr/base/geometry/mesh.hpp"

namespace pcavr::model {

/// The content to read from a file: the shape alone takes less memory.
enum class MeshContent { kAll, kShape };

// Readers of one file type each, of the file as stored. Sizes are checked against the bytes of the
// file before memory is taken for them, and all indices are valid; coordinates may not be finite,
// and there may be no triangles. Normals and colours are kept where all vertices have them. They
// throw MeshFault for contents that are not of the type or contradict themselves.

/// Binary or ASCII. Equal corners are welded, in the order of their first use.
[[nodiscard]] TriangleMesh read_stl_mesh(const std::filesystem::path& file);

/// Faces and triangle strips of an ASCII or binary PLY of either byte order.
[[nodiscard]] TriangleMesh read_ply_mesh(const std::filesystem::path& file);

/// Vertices and faces of a Wavefront OBJ; lines, curves, texture coordinates and materials are
/// ignored.
[[nodiscard]] TriangleMesh read_obj_mesh(const std::filesystem::path& file, MeshContent content);

/// Triangles, strips and fans of the scene of a glTF 2.0 file, node transforms applied. Points,
/// lines, cameras, lights, materials, skins, morph targets and animations are ignored.
[[nodiscard]] TriangleMesh read_gltf_mesh(const std::filesystem::path& file);

/// Reads any other type by assimp, in a process of its own.
[[nodiscard]] TriangleMesh read_foreign_mesh(const std::filesystem::path& file);

/// Appends a face of the mesh's vertices, triangulated. Throws MeshFault for more than 4096
/// corners, because triangulation takes the square of their number.
void append_face(const std::vector<std::uint32_t>& corners, int line, TriangleMesh& mesh);

}  // namespace pcavr::model
