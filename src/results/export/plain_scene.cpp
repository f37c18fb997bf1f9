// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/results/export/plain_scene.hpp"

#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/perception/scene/glb_file.hpp"
#include "pcavr/perception/scene/ply_file.hpp"
#include "pcavr/perception/scene/scene_text.hpp"
#include "pcavr/recordings/cloud/cloud_file.hpp"

#include "results/export/export_text.hpp"
#include "results/export/streamed_tiles.hpp"

namespace pcavr {
namespace {

constexpr Rgb8 kUncoloured{200, 200, 200};

struct NamedMesh {
  std::string name;
  TriangleMesh mesh_base;  ///< with normals and colours
};

NamedMesh completed(std::string name, TriangleMesh mesh_base) {
  if (mesh_base.normals.empty()) compute_vertex_normals(mesh_base);
  if (mesh_base.colors.empty()) mesh_base.colors.assign(mesh_base.vertices.size(), kUncoloured);
  return {.name = std::move(name), .mesh_base = std::move(mesh_base)};
}

/// The scan, where there is one, and the bodies.
Expected<std::vector<NamedMesh>> meshes_of(const SceneManifest& scene) {
  std::vector<NamedMesh> meshes;
  if (scene.is_scanned()) {
    Expected<TriangleMesh> scan = read_ply(scene.folder / kMeshFile);
    if (!scan) return scan.error();
    meshes.push_back(completed("scan", *std::move(scan)));
  }
  for (const SceneObjectEntry& object : scene.objects) {
    const Expected<CadModel> model = read_object_model(scene, object);
    if (!model) return model.error();
    meshes.push_back(completed(object.name, transformed(object.T_base_object, model->mesh_object)));
  }
  return meshes;
}

TriangleMesh merged(const std::vector<NamedMesh>& meshes) {
  TriangleMesh all;
  for (const auto& [name, mesh] : meshes) {
    const auto first = static_cast<std::uint32_t>(all.vertices.size());
    all.vertices.insert(all.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
    all.normals.insert(all.normals.end(), mesh.normals.begin(), mesh.normals.end());
    all.colors.insert(all.colors.end(), mesh.colors.begin(), mesh.colors.end());
    for (const auto& [a, b, c] : mesh.triangles) {
      all.triangles.push_back({first + a, first + b, first + c});
    }
  }
  return all;
}

std::string coloured_obj(const std::vector<NamedMesh>& meshes) {
  std::string text = "# SI units, frame base\n";
  std::size_t first = 1;
  for (const auto& [name, mesh] : meshes) {
    text += fmt::format("o {}\n", name) + detail::obj_text(mesh, first);
    first += mesh.vertices.size();
  }
  return text;
}

Error nothing_in(const SceneManifest& scene) {
  return {.message = "has neither a scan nor bodies", .file = scene.folder.string()};
}

/// A file of the scene under another name. `count` is of its triangles or points.
Expected<PlainScene> copied(const std::filesystem::path& source, const std::string& name,
                            std::size_t count, const std::filesystem::path& folder) {
  const Expected<std::string> bytes = read_file(source);
  if (!bytes) return bytes.error();
  if (auto written = write_file(folder / name, *bytes); !written) return written.error();
  return PlainScene{.file = name, .count = count};
}

Expected<PlainScene> write_gltf(const SceneManifest& scene, const std::filesystem::path& folder) {
  const Expected<GlbContent> content = read_glb(scene.folder / kDisplayFile);
  if (!content) return content.error();
  std::size_t triangles = 0;
  for (const GlbNode& node : content->nodes) triangles += node.triangles;
  if (triangles == 0) return nothing_in(scene);
  return copied(scene.folder / kDisplayFile, "scene.glb", triangles, folder);
}

Expected<PlainScene> write_pcd(const SceneManifest& scene, const std::filesystem::path& folder) {
  const Expected<RecordedCloud> cloud = read_cloud(scene.folder / kCloudPcdFile);
  if (!cloud) return cloud.error();
  if (cloud->points.empty()) {
    return Error{.message = "has no points: the recording has no images",
                 .file = (scene.folder / kCloudPcdFile).string(),
                 .hint = "export it as obj, ply, stl or gltf, which have its bodies"};
  }
  return copied(scene.folder / kCloudPcdFile, "scene.pcd", cloud->points.size(), folder);
}

Expected<PlainScene> write_tiles(const SceneManifest& scene, std::vector<NamedMesh> meshes,
                                 const std::filesystem::path& folder) {
  NamedMesh scan;
  if (scene.is_scanned()) {
    scan = std::move(meshes.front());
    meshes.erase(meshes.begin());
  }
  const TriangleMesh bodies = merged(meshes);
  if (scan.mesh_base.triangles.empty() && bodies.triangles.empty()) return nothing_in(scene);
  const Expected<std::size_t> count =
      detail::write_streamed_tiles(scan.mesh_base, bodies, scene.voxel_size, folder);
  if (!count) return count.error();
  return PlainScene{.file = detail::kTilesetFile, .count = *count};
}

}  // namespace

std::optional<PlainFormat> plain_format_of(std::string_view name) {
  for (const auto& [known, format] : kPlainFormats) {
    if (name == known) return format;
  }
  return std::nullopt;
}

Expected<PlainScene> write_plain_scene(const SceneManifest& scene, PlainFormat format,
                                       const std::filesystem::path& folder) {
  if (format == PlainFormat::gltf) return write_gltf(scene, folder);
  if (format == PlainFormat::pcd) return write_pcd(scene, folder);
  Expected<std::vector<NamedMesh>> meshes = meshes_of(scene);
  if (!meshes) return meshes.error();
  if (format == PlainFormat::tiles) return write_tiles(scene, *std::move(meshes), folder);
  const TriangleMesh all = merged(*meshes);
  if (all.triangles.empty()) return nothing_in(scene);
  const bool is_ply = format == PlainFormat::ply, is_obj = format == PlainFormat::obj;
  PlainScene written{.file = is_ply   ? "scene.ply"
                             : is_obj ? "scene.obj"
                                      : "scene.stl",
                     .count = all.triangles.size()};
  const std::string bytes = is_ply   ? format_ply(all)
                            : is_obj ? coloured_obj(*meshes)
                                     : detail::stl_bytes(all);
  if (auto done = write_file(folder / written.file, bytes); !done) return done.error();
  return written;
}

}  // namespace pcavr
