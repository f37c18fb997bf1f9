// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "model/mesh_file.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <exception>
#include <new>
#include <utility>

#include <assimp/DefaultIOSystem.h>
#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include "pcavr/core/input_file.hpp"
#include "pcavr/geometry/pixel.hpp"
#include "pcavr/model/cad_model.hpp"

#include "model/declared_size.hpp"
#include "model/mesh_repair.hpp"
#include "model/ply_data.hpp"
#include "model/polygon.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

/// [unit of the file] Of a coordinate in a mesh. The unit may be millimetres, so this is far above
/// ranges::kCoordinate; squares and volumes stay finite in single precision.
constexpr float kMaxMeshCoordinate = 1e7F;

/// Properties of a supported file type.
struct MeshType {
  std::string extension;           ///< in lower case, with the dot
  bool has_vertex_normals = true;  ///< an STL's belong to its faces
  bool has_linear_colors = false;  ///< COLOR_0 of glTF 2.0 is linear, the other types use sRGB
};

std::optional<MeshType> mesh_type(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  MeshType type{.extension = extension};
  type.has_vertex_normals = extension != ".stl";
  type.has_linear_colors = extension == ".glb" || extension == ".gltf";
  const bool is_known = type.has_linear_colors || !type.has_vertex_normals || extension == ".obj" ||
                        extension == ".ply" || extension == ".dae";
  return is_known ? std::optional(std::move(type)) : std::nullopt;
}

/// IEC 61966-2-1.
double srgb_from_linear(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

std::uint8_t to_byte(float channel, bool is_linear) {
  const double clamped = std::clamp(static_cast<double>(channel), 0.0, 1.0);
  const double encoded = is_linear ? srgb_from_linear(clamped) : clamped;
  return static_cast<std::uint8_t>(clamp_to_int(255.0 * encoded + 0.5, 0, 255));
}

/// Appends one part of the file, transformed to the file's frame.
void append(const aiMesh& part, const aiMatrix4x4& T_file_part, const MeshType& type,
            TriangleMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  const aiMatrix3x3 normal_matrix = aiMatrix3x3(T_file_part).Inverse().Transpose();
  for (unsigned i = 0; i < part.mNumVertices; ++i) {
    const aiVector3D p = T_file_part * part.mVertices[i];
    mesh.vertices.emplace_back(p.x, p.y, p.z);
    if (type.has_vertex_normals && part.HasNormals()) {
      const aiVector3D n = normal_matrix * part.mNormals[i];
      mesh.normals.push_back(Eigen::Vector3f(n.x, n.y, n.z).normalized());
    }
    if (part.HasVertexColors(0)) {
      const aiColor4D& c = part.mColors[0][i];
      mesh.colors.push_back({to_byte(c.r, type.has_linear_colors),
                             to_byte(c.g, type.has_linear_colors),
                             to_byte(c.b, type.has_linear_colors)});
    }
  }
  const bool is_mirrored = T_file_part.Determinant() < 0.0F;
  for (unsigned i = 0; i < part.mNumFaces; ++i) {
    const aiFace& face = part.mFaces[i];
    std::vector<std::uint32_t> polygon;
    for (unsigned k = 0; k < face.mNumIndices; ++k) polygon.push_back(first + face.mIndices[k]);
    if (is_mirrored) std::reverse(polygon.begin(), polygon.end());
    model::append_polygon(std::move(polygon), mesh);
  }
}

/// The scene's triangles with all node transforms applied. Iterative depth-first traversal:
/// recursion would overflow the stack on a malicious, deeply nested file.
TriangleMesh flatten(const aiScene& scene, const MeshType& type) {
  TriangleMesh mesh;
  std::vector<std::pair<const aiNode*, aiMatrix4x4>> open{
      {scene.mRootNode, scene.mRootNode->mTransformation}};
  while (!open.empty()) {
    const auto [node, T_file_node] = open.back();
    open.pop_back();
    for (unsigned i = 0; i < node->mNumMeshes; ++i) {
      append(*scene.mMeshes[node->mMeshes[i]], T_file_node, type, mesh);
    }
    for (unsigned i = node->mNumChildren; i > 0; --i) {
      const aiNode* child = node->mChildren[i - 1];
      open.emplace_back(child, T_file_node * child->mTransformation);
    }
  }
  // Kept only if all parts have them.
  if (mesh.normals.size() != mesh.vertices.size()) mesh.normals.clear();
  if (mesh.colors.size() != mesh.vertices.size()) mesh.colors.clear();
  return mesh;
}

Error not_a_mesh(const fs::path& file, const std::string& reason) {
  return {.message = "is not a readable mesh: " + reason,
          .file = file.string(),
          .hint = "export it again as .obj, .stl, .ply, .dae or .glb"};
}

/// assimp's messages are long, may have several lines, and repeat the path.
std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

/// Rejects pipes and devices also for the files that a mesh refers to (buffers, materials).
class RegularFiles final : public Assimp::DefaultIOSystem {
 public:
  // The default implementation opens the file to test whether it exists, and would block on a pipe.
  bool Exists(const char* file) const override { return regular_file_size(file).has_value(); }
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    return regular_file_size(file) ? DefaultIOSystem::Open(file, mode) : nullptr;
  }
};

Expected<TriangleMesh> read_with_assimp(const fs::path& file, const MeshType& type) {
  try {
    Assimp::Importer importer;
    importer.SetIOHandler(new RegularFiles);  // the importer takes ownership
    // Coordinates as stored: no unit scaling, no axis conversion; but Collada's own unit is
    // applied, as RViz and Gazebo do, which ignore its up axis, too: assimp would turn z up into y
    // up. Polygons are not triangulated by assimp, which aborts the process if they are malformed.
    importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
    const auto ply =
        type.extension == ".ply" ? model::ply_with_unambiguous_data(file) : std::nullopt;
    const aiScene* scene = ply ? importer.ReadFileFromMemory(ply->data(), ply->size(),
                                                             aiProcess_ValidateDataStructure, "ply")
                               : importer.ReadFile(file.string(), aiProcess_ValidateDataStructure);
    if (scene == nullptr) return not_a_mesh(file, first_line(importer.GetErrorString()));
    if (scene->mRootNode == nullptr) return not_a_mesh(file, "it is empty");
    return flatten(*scene, type);
  } catch (const std::bad_alloc&) {
    return not_a_mesh(file, "out of memory");
  } catch (const std::exception& failure) {
    return not_a_mesh(file, first_line(failure.what()));
  }
}

}  // namespace

Expected<TriangleMesh> model::import_mesh(const fs::path& file) {
  const std::optional<MeshType> type = mesh_type(file);
  if (!type) {
    return Error{.message = "has an unknown mesh type '" + file.extension().string() + "'",
                 .file = file.string(),
                 .hint = "convert it to .obj, .stl, .ply, .dae, .glb or .gltf"};
  }
  const Expected<bool> is_there = is_present(file);
  if (!is_there) return is_there.error();
  if (!*is_there) {
    return Error{.message = "mesh file is missing",
                 .file = file.string(),
                 .hint = "add the file, or correct the path"};
  }
  const Expected<std::uintmax_t> size = regular_file_size(file);
  if (!size) return size.error();
  if (const auto reason = model::find_size_mismatch(file, type->extension)) {
    return not_a_mesh(file, *reason);
  }
  Expected<TriangleMesh> mesh = read_with_assimp(file, *type);
  if (!mesh) return mesh;
  if (mesh->triangles.empty()) return not_a_mesh(file, "it has no triangles");
  for (std::size_t i = 0; i < mesh->vertices.size(); ++i) {
    // NaN fails this comparison, too.
    if ((mesh->vertices[i].cwiseAbs().array() <= kMaxMeshCoordinate).all()) continue;
    return Error{.message = "has a coordinate that is not finite, or beyond 10 000 km",
                 .file = file.string(),
                 .place = "vertex " + std::to_string(i),
                 .hint = "export the mesh again"};
  }
  return mesh;
}

Expected<TriangleMesh> read_mesh(const fs::path& file) {
  const Expected<TriangleMesh> mesh = model::import_mesh(file);
  if (!mesh) return mesh;
  TriangleMesh sound = model::without_degenerate_triangles(model::weld_vertices(*mesh));
  if (sound.triangles.empty()) return not_a_mesh(file, "its triangles have no area");
  return sound;
}

}  // namespace pcavr
