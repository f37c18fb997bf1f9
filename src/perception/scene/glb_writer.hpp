// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/perception/scene/palette.hpp"

namespace pcavr {

/// Material of a mesh.
enum class GlbMaterial {
  captured,  ///< unlit, as its colours contain the lighting (KHR_materials_unlit), two-sided
  body,      ///< lit by the viewer
};

/// Builds a binary glTF 2.0 file [Khronos 2021] from meshes and nodes.
class GlbWriter {
 public:
  /// Returns the mesh index. Converts sRGB colours to linear (16 bits); normalises the normals, or
  /// computes missing ones. The mesh must not be empty. `color` is that of a body without colours.
  int add_mesh(const std::string& name, const TriangleMesh& mesh, GlbMaterial material,
               const Rgb8& color = kObjectColors.front());

  /// A captured mesh with a texture, a JPEG file, and without vertex colours, as a viewer would
  /// multiply both.
  int add_textured_mesh(const std::string& name, const TriangleMesh& mesh,
                        const std::vector<Eigen::Vector2f>& coordinates, const std::string& jpeg);

  /// Adds a node, with a mesh unless `mesh` is negative. Returns its index.
  int add_node(const std::string& name, const Pose& T_parent_node, int mesh);

  /// The bytes of the file; `root` is the scene's root node.
  [[nodiscard]] std::string finish(int root, const std::vector<int>& children);

 private:
  int add_view(std::size_t first_byte, int target);
  int add_accessor(int view, int component_type, const char* type, std::size_t count);
  int add_vectors(const std::vector<Eigen::Vector3f>& vectors, bool with_bounds);
  int add_colors(const std::vector<Rgb8>& colors);
  int add_indices(const TriangleMesh& mesh);
  int add_texture_coordinates(const std::vector<Eigen::Vector2f>& coordinates);
  int material_index(const nlohmann::json& material);
  int surface_material(GlbMaterial material, bool has_colors, const Rgb8& color);
  int textured_material(std::size_t texture);
  /// Begins a primitive with positions and normals.
  nlohmann::json begin_primitive(const TriangleMesh& mesh);
  /// Adds a mesh of this primitive; returns its index.
  int add_primitive(const std::string& name, const nlohmann::json& primitive);
  void add_textures();

  nlohmann::json document_;
  std::string buffer_;
  std::vector<std::string> textures_;
};

/// The bytes of a file with these JSON and binary chunks; the latter must be padded to 4 bytes.
[[nodiscard]] std::string assemble_glb(const nlohmann::json& document, std::string_view buffer);

/// The rotation from z-up coordinates to glTF's y-up coordinates.
[[nodiscard]] Pose glb_root_pose();

}  // namespace pcavr
