// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "base/model/mesh_file.hpp"

#include <algorithm>
#include <cctype>
#include <exception>
#include <new>
#include <string>
#include <utility>

#include "pcavr/base/core/input_file.hpp"
#include "pcavr/base/model/cad_model.hpp"

#include "base/model/mesh_fault.hpp"
#include "base/model/mesh_repair.hpp"
#include "base/model/polygon.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

/// Largest coordinate in a mesh [unit of the file]. The unit may be millimetres, so this is far
/// above ranges::kCoordinate; squares and volumes stay finite in single precision.
constexpr float kMaxMeshCoordinate = 1e7F;

/// The extension in lower case, with the dot.
std::string extension_of(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

bool is_known(const std::string& extension) {
  const auto types = {".obj", ".stl", ".ply", ".dae", ".glb", ".gltf"};
  return std::find(types.begin(), types.end(), extension) != types.end();
}

TriangleMesh read_type(const fs::path& file, const std::string& extension,
                       model::MeshContent content) {
  if (extension == ".stl") return model::read_stl_mesh(file);
  if (extension == ".ply") return model::read_ply_mesh(file);
  if (extension == ".obj") return model::read_obj_mesh(file, content);
  if (extension == ".dae") return model::read_foreign_mesh(file);
  return model::read_gltf_mesh(file);
}

/// `reason` may come from a library: its first line is used.
Error not_a_mesh(const fs::path& file, const std::string& reason, int line = 0,
                 const std::string& hint = {}) {
  return {.message = "is not a readable mesh: " + reason.substr(0, reason.find('\n')),
          .file = file.string(),
          .line = line,
          .hint = hint.empty() ? "export it again as .obj, .stl, .ply, .dae or .glb" : hint};
}

}  // namespace

Expected<TriangleMesh> model::import_mesh(const fs::path& file, MeshContent content) {
  const std::string extension = extension_of(file);
  if (!is_known(extension)) {
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
  TriangleMesh mesh;
  try {
    mesh = read_type(file, extension, content);
  } catch (const MeshFault& fault) {
    return not_a_mesh(file, fault.what(), fault.line(), fault.hint());
  } catch (const std::bad_alloc&) {
    return not_a_mesh(file, "out of memory");
  }
  if (mesh.triangles.empty()) return not_a_mesh(file, "it has no triangles");
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle) {
      // NaN fails this comparison, too.
      if ((mesh.vertices[v].cwiseAbs().array() <= kMaxMeshCoordinate).all()) continue;
      return Error{.message = "has a coordinate that is not finite, or beyond 10 000 km",
                   .file = file.string(),
                   .place = "vertex " + std::to_string(v),
                   .hint = "export the mesh again"};
    }
  }
  return mesh;
}

void model::append_face(const std::vector<std::uint32_t>& corners, int line, TriangleMesh& mesh) {
  constexpr std::size_t kMaxCorners = 4096;
  if (corners.size() == 3) {
    mesh.triangles.push_back({corners[0], corners[1], corners[2]});
  } else if (corners.size() <= kMaxCorners) {
    append_polygon(corners, mesh);
  } else {
    throw MeshFault("a face has " + std::to_string(corners.size()) + " corners; at most " +
                        std::to_string(kMaxCorners) + " are read",
                    line, "export it with triangles only");
  }
}

Expected<TriangleMesh> read_mesh(const fs::path& file) {
  const Expected<TriangleMesh> mesh = model::import_mesh(file, model::MeshContent::kAll);
  if (!mesh) return mesh;
  TriangleMesh sound = model::without_degenerate_triangles(model::weld_vertices(*mesh));
  if (sound.triangles.empty()) return not_a_mesh(file, "its triangles have no area");
  return sound;
}

}  // namespace pcavr
