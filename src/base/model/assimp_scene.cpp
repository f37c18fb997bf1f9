// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "base/model/assimp_scene.hpp"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <assimp/DefaultIOSystem.h>
#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/scene.h>

#include "pcavr/base/core/input_file.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/base/geometry/pixel.hpp"

#include "base/model/mesh_fault.hpp"
#include "base/model/mesh_readers.hpp"

namespace pcavr::model {
namespace {

std::uint8_t color_byte(float channel) {
  return static_cast<std::uint8_t>(
      clamp_to_int(255.0 * static_cast<double>(channel) + 0.5, 0, 255));
}

/// Appends one part of the file, transformed to the file's frame.
void append_part(const aiMesh& part, const aiMatrix4x4& T_file_part, TriangleMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  const aiMatrix3x3 normal_matrix = aiMatrix3x3(T_file_part).Inverse().Transpose();
  for (unsigned i = 0; part.HasPositions() && i < part.mNumVertices; ++i) {
    const aiVector3D p = T_file_part * part.mVertices[i];
    mesh.vertices.emplace_back(p.x, p.y, p.z);
    if (part.HasNormals()) {
      const aiVector3D n = normal_matrix * part.mNormals[i];
      mesh.normals.push_back(Eigen::Vector3f(n.x, n.y, n.z).normalized());
    }
    if (part.HasVertexColors(0)) {
      const aiColor4D& c = part.mColors[0][i];
      mesh.colors.push_back({color_byte(c.r), color_byte(c.g), color_byte(c.b)});
    }
  }
  const bool is_mirrored = T_file_part.Determinant() < 0.0F;
  for (unsigned i = 0; i < part.mNumFaces; ++i) {
    const aiFace& face = part.mFaces[i];
    std::vector<std::uint32_t> polygon;
    for (unsigned k = 0; k < face.mNumIndices; ++k) {
      if (face.mIndices[k] >= mesh.vertices.size() - first) {
        throw MeshFault("a face refers to a vertex that is not there");
      }
      polygon.push_back(first + face.mIndices[k]);
    }
    if (is_mirrored) std::reverse(polygon.begin(), polygon.end());
    append_face(polygon, 0, mesh);
  }
}

/// The scene's triangles with all node transforms applied. Iterative depth-first traversal:
/// recursion would overflow the stack on a malicious, deeply nested file.
TriangleMesh flatten(const aiScene& scene) {
  TriangleMesh mesh;
  std::vector<std::pair<const aiNode*, aiMatrix4x4>> open{
      {scene.mRootNode, scene.mRootNode->mTransformation}};
  while (!open.empty()) {
    const auto [node, T_file_node] = open.back();
    open.pop_back();
    for (unsigned i = 0; i < node->mNumMeshes; ++i) {
      if (node->mMeshes[i] >= scene.mNumMeshes)
        throw MeshFault("a node has a mesh that is not there");
      append_part(*scene.mMeshes[node->mMeshes[i]], T_file_node, mesh);
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

/// Elements in each other. assimp visits them by recursion, which overflows the stack of a deeply
/// nested file; exporters nest far less.
constexpr int kMaxElementDepth = 1000;

/// One past the markup that begins at `at`, a '<'; the text's end where it does not end.
std::size_t end_of_markup(std::string_view text, std::size_t at) {
  constexpr std::pair<std::string_view, std::string_view> kOpaque[] = {
      {"<!--", "-->"}, {"<![CDATA[", "]]>"}, {"<?", "?>"}};
  for (const auto& [begin, end] : kOpaque) {
    if (!text.substr(at).starts_with(begin)) continue;
    const std::size_t found = text.find(end, at + begin.size());
    return found == text.npos ? text.size() : found + end.size();
  }
  char quote = '\0';
  for (std::size_t i = at; i < text.size(); ++i) {
    if (quote != '\0') {
      if (text[i] == quote) quote = '\0';
    } else if (text[i] == '"' || text[i] == '\'') {
      quote = text[i];
    } else if (text[i] == '>') {
      return i + 1;
    }
  }
  return text.size();
}

/// Throws MeshFault where elements are nested too deeply for assimp.
void check_nesting(const std::filesystem::path& file) {
  Expected<std::string> text = read_file(file);
  if (!text) throw MeshFault(text.error().message);
  std::erase(*text, '\0');  // of UTF-16
  int depth = 0;
  for (std::size_t at = text->find('<'); at != text->npos; at = text->find('<', at)) {
    const std::size_t end = end_of_markup(*text, at);
    const char first = at + 1 < text->size() ? (*text)[at + 1] : '\0';
    const bool is_empty = end >= 2 && (*text)[end - 2] == '/';
    if (first == '/') {
      --depth;
    } else if (first != '!' && first != '?' && !is_empty && ++depth > kMaxElementDepth) {
      throw MeshFault("it is nested too deeply: over " + std::to_string(kMaxElementDepth) +
                      " elements");
    }
    at = end;
  }
}

/// Rejects pipes and devices also for the files that a mesh refers to.
class RegularFiles final : public Assimp::DefaultIOSystem {
 public:
  // The default implementation opens the file to test whether it exists, and would block on a pipe.
  bool Exists(const char* file) const override { return regular_file_size(file).has_value(); }
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    return regular_file_size(file) ? DefaultIOSystem::Open(file, mode) : nullptr;
  }
};

}  // namespace

TriangleMesh read_assimp_scene(const std::filesystem::path& file) {
  check_nesting(file);
  Assimp::Importer importer;
  importer.SetIOHandler(new RegularFiles);  // the importer takes ownership
  // Coordinates as stored: no axis conversion, but Collada's own unit is applied, as RViz and
  // Gazebo do, which ignore its up axis, too: assimp would turn z up into y up. Polygons are not
  // triangulated by assimp, which aborts the process if they are malformed. The scene is not
  // validated by assimp, which refuses it for parts that are not used here: cameras, lights and
  // materials.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFile(file.string(), 0);
  if (scene == nullptr) throw MeshFault(importer.GetErrorString());
  if (scene->mRootNode == nullptr) throw MeshFault("it is empty");
  return flatten(*scene);
}

}  // namespace pcavr::model
