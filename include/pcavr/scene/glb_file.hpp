// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "pcavr/core/expected.hpp"
#include "pcavr/geometry/pose.hpp"

namespace pcavr {

/// A node of a glTF file, with the size of its mesh.
struct GlbNode {
  std::string name;
  Pose T_parent_node;
  std::size_t triangles = 0;
};
struct GlbContent {
  std::string root;  ///< name of the scene's root node
  Pose T_viewer_root;
  std::vector<GlbNode> nodes;  ///< the root's children
};
/// Reads a file written by GlbWriter, and checks lengths, offsets and indices. Any other content is
/// an Error.
[[nodiscard]] Expected<GlbContent> read_glb(const std::filesystem::path& file);

/// The static mesh of such a file as a separate file, in base: without the objects and the rotation
/// to y-up. Empty where the file has no static mesh. The binary chunk is unchanged.
struct StaticMeshGlb {
  std::string bytes;
  std::size_t triangles = 0;
};
[[nodiscard]] Expected<StaticMeshGlb> read_static_mesh_glb(const std::filesystem::path& file);

}  // namespace pcavr
