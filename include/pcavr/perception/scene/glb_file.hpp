// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/pose.hpp"

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

/// The nodes of scene.glb beside the objects.
inline constexpr char kStaticMeshNode[] = "static_mesh";
/// Parts of the support planes that no view saw: for display only.
inline constexpr char kUnseenSupportNode[] = "unseen_support";

/// The mesh of a node of such a file as a separate file, in its own axes: without the other nodes
/// and the rotation to y-up. Empty where the file has no such node.
struct NodeGlb {
  std::string bytes;
  std::size_t triangles = 0;
  std::string texture;  ///< a JPEG file; empty where the mesh has none
};
/// The texture is separated, as all levels of a scene have the same one, and named `texture_uri` in
/// `bytes`.
[[nodiscard]] Expected<NodeGlb> read_node_glb(const std::filesystem::path& file,
                                              const std::string& node,
                                              const std::string& texture_uri);

}  // namespace pcavr
