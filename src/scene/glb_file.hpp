// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "pcavr/core/expected.hpp"
#include "pcavr/geometry/mesh.hpp"

namespace pcavr {

/// How a mesh is to look in a viewer.
enum class GlbMaterial {
  captured,  ///< its colours hold the light of the place already (KHR_materials_unlit), two-sided
  body,      ///< lit by the viewer
};

/// A binary glTF 2.0 file [Khronos 2021], put together mesh by mesh and node by node.
class GlbWriter {
 public:
  /// Returns the mesh's number. sRGB colours become linear ones (16 bits); normals are made unit,
  /// or computed where there are none. The mesh must have a triangle.
  int add_mesh(const std::string& name, const TriangleMesh& mesh, GlbMaterial material);

  /// A node, with a mesh unless `mesh` is negative. Returns its number.
  int add_node(const std::string& name, const Pose& T_parent_node, int mesh);

  /// The bytes of the file. `root` holds `children`; a viewer shows it.
  [[nodiscard]] std::string finish(int root, const std::vector<int>& children);

 private:
  int add_view(std::size_t first_byte, int target);
  int add_accessor(int view, int component_type, const char* type, std::size_t count);
  int add_vectors(const std::vector<Eigen::Vector3f>& vectors, bool with_bounds);
  int add_colors(const std::vector<Rgb8>& colors);
  int add_indices(const TriangleMesh& mesh);
  int material_number(GlbMaterial material, bool has_colors);

  nlohmann::json document_;
  std::string buffer_;
};

/// The bytes of a file with this JSON and this binary part, which must be padded to 4 bytes.
[[nodiscard]] std::string assemble_glb(const nlohmann::json& document, std::string_view buffer);

/// The rotation that turns z-up coordinates into glTF's y-up ones.
[[nodiscard]] Pose glb_root_pose();

/// A node of a glTF file with its own mesh's size.
struct GlbNode {
  std::string name;
  Pose T_parent_node;
  std::size_t triangles = 0;
};
struct GlbContent {
  std::string root;  ///< name of the one node that the scene shows
  Pose T_viewer_root;
  std::vector<GlbNode> nodes;  ///< the root's children
};
/// Opens a file that GlbWriter wrote, and checks lengths, offsets and indices. Any other content
/// is an Error.
[[nodiscard]] Expected<GlbContent> read_glb(const std::filesystem::path& file);

/// The static mesh of such a file as a file of its own, in base: without the objects and without
/// the turn to y-up. No bytes where the file has no static mesh. The binary part stays whole.
struct StaticMeshGlb {
  std::string bytes;
  std::size_t triangles = 0;
};
[[nodiscard]] Expected<StaticMeshGlb> read_static_mesh_glb(const std::filesystem::path& file);

}  // namespace pcavr
