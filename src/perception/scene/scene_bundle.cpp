// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/scene/scene_bundle.hpp"

#include <algorithm>
#include <functional>
#include <limits>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/geometry/sharp_edges.hpp"
#include "pcavr/perception/scene/glb_file.hpp"
#include "pcavr/perception/scene/object_colors.hpp"
#include "pcavr/perception/scene/ply_file.hpp"
#include "pcavr/perception/scene/scene_text.hpp"
#include "pcavr/recordings/cloud/cloud_file.hpp"
#include "pcavr/recordings/recording/image_codec.hpp"
#include "pcavr/recordings/recording/recording.hpp"

#include "perception/scene/glb_writer.hpp"
#include "ply_parts.hpp"
#include "preview.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

/// Adds a level of the static mesh as a node; returns its index as the root's child, or none where
/// it is empty.
std::vector<int> add_static_mesh(GlbWriter& glb, const Scene& scene, std::size_t level) {
  const std::vector<TriangleMesh>& levels = scene.levels_of_detail_base;
  const TriangleMesh& mesh_base = level < levels.size() ? levels[level] : scene.mesh_base;
  if (mesh_base.triangles.empty()) return {};
  const int mesh =
      scene.texture && level < scene.texture->coordinates.size()
          ? glb.add_textured_mesh("static_mesh", mesh_base, scene.texture->coordinates[level],
                                  scene.texture->jpeg)
          : glb.add_mesh("static_mesh", mesh_base, GlbMaterial::captured);
  return {glb.add_node("static_mesh", Pose(), mesh)};
}

std::string format_display(const Scene& scene) {
  GlbWriter glb;
  const int root = glb.add_node("base", glb_root_pose(), -1);
  std::vector<int> children = add_static_mesh(glb, scene, 0);
  if (!scene.unseen_support_base.triangles.empty()) {
    const int mesh =
        glb.add_mesh(kUnseenSupportNode, scene.unseen_support_base, GlbMaterial::captured);
    children.push_back(glb.add_node(kUnseenSupportNode, Pose(), mesh));
  }
  const std::vector<Rgb8> colors = object_colors(scene);
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const SceneObject& object = scene.objects[i];
    if (object.evidence == kNotSeen) continue;
    const std::string& name = object.model.name;
    const int mesh = object.texture
                         ? glb.add_textured_mesh(name, object.texture->mesh_object,
                                                 object.texture->coordinates, object.texture->jpeg)
                         : glb.add_mesh(name, with_sharp_edges(object.model.mesh_object),
                                        GlbMaterial::body, colors[i]);
    children.push_back(glb.add_node(name, object.T_base_object, mesh));
  }
  return glb.finish(root, children);
}

std::string format_level(const Scene& scene, std::size_t level) {
  GlbWriter glb;
  const int root = glb.add_node("base", glb_root_pose(), -1);
  return glb.finish(root, add_static_mesh(glb, scene, level));
}

/// Writes the object in its own axes, so that it can be read back as a CAD file.
std::string format_object(const CadModel& model) {
  GlbWriter glb;
  const int mesh = glb.add_mesh(model.name, with_sharp_edges(model.mesh_object), GlbMaterial::body);
  return glb.finish(glb.add_node(model.name, Pose(), mesh), {});
}

std::string format_link(const SceneRobot::Link& link) {
  GlbWriter glb;
  const int mesh = glb.add_mesh(link.name, with_sharp_edges(link.mesh_link), GlbMaterial::body);
  return glb.finish(glb.add_node(link.name, Pose(), mesh), {});
}

/// Writes a file; creates its folder where needed.
Expected<void> write_with_folder(const fs::path& file, const std::string& content) {
  std::error_code code;
  fs::create_directories(file.parent_path(), code);
  if (code) {
    return Error{.message = "can't be created: " + code.message(),
                 .file = file.parent_path().string(),
                 .hint = "choose a writable folder on a disk with free space"};
  }
  return write_file(file, content);
}

}  // namespace

Expected<void> write_scene(const Scene& scene, const fs::path& folder, Parallelism parallelism) {
  struct File {
    fs::path name;
    std::function<std::string()> content;  ///< lazy, to keep only one file in memory
  };
  std::vector<File> files = {
      {kManifestFile, [&] { return format_scene_manifest(manifest_of(scene)); }},
      {kDisplayFile, [&] { return format_display(scene); }},
      {kCloudPcdFile, [&] { return format_pcd(scene.cloud_base); }},
      {kTrajectoryFile, [&] { return format_trajectory(scene.camera_trajectory); }},
      {kPreviewFile, [&] { return encode_color_png(render_preview(scene, parallelism)); }}};
  for (const SceneObject& object : scene.objects) {
    if (object.evidence == kNotSeen) continue;
    files.push_back(
        {object_file(object.model.name), [&model = object.model] { return format_object(model); }});
  }
  if (scene.robot) {
    files.push_back({kRobotFile, [&] { return scene.robot->urdf; }});
    for (std::size_t i = 0; i < scene.robot->links.size(); ++i) {
      files.push_back(
          {link_file(i), [&link = scene.robot->links[i]] { return format_link(link); }});
    }
  }
  for (std::size_t level = 1; level < scene.levels_of_detail_base.size(); ++level) {
    files.push_back(
        {level_of_detail_file(level), [&, level] { return format_level(scene, level); }});
  }
  for (const File& file : files) {
    if (const auto written = write_with_folder(folder / file.name, file.content()); !written) {
      return written.error();
    }
  }
  if (const auto written = write_ply(scene.mesh_base, folder / kMeshFile); !written) {
    return written.error();
  }
  if (const auto written = write_ply(scene.cloud_base, folder / kCloudFile); !written) {
    return written.error();
  }
  return scene.occupancy.write(folder / kOccupancyFile);
}

Expected<SceneManifest> read_scene_manifest(const fs::path& folder) {
  const fs::path file = folder / kManifestFile;
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  Expected<SceneManifest> manifest = parse_scene_manifest(*text, file.string());
  if (!manifest) return manifest;
  if (!text->ends_with('\n')) {
    return Error{.message = "is truncated: the last line has no newline",
                 .file = file.string(),
                 .hint = "build the scene again, or add the newline if an editor removed it"};
  }
  manifest->folder = folder;
  return manifest;
}

Expected<CadModel> read_object_model(const SceneManifest& scene, const SceneObjectEntry& object) {
  CadOptions options;
  // The mesh is not simplified again: the stated error would be wrong.
  if (object.simplified) options.max_triangles = std::numeric_limits<int>::max();
  Expected<CadModel> model = read_cad_model(scene.folder / object.mesh, object.name, options);
  if (!model || !object.simplified) return model;
  model->simplification = object.simplified->simplification;
  model->volume = object.simplified->volume;
  model->centre_of_mass_object = object.simplified->centre_of_mass_object;
  return model;
}

Expected<Trajectory> read_camera_trajectory(const SceneManifest& scene) {
  const fs::path file = scene.folder / kTrajectoryFile;
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  // Every version writes a final newline; older ones do not write the line count.
  const bool is_counted = scene.lines && scene.lines->contains(kTrajectoryFile);
  const auto newlines = static_cast<std::size_t>(std::count(text->begin(), text->end(), '\n'));
  const Expected<void> complete =
      check_line_count(*text, is_counted ? scene.lines->at(kTrajectoryFile) : newlines, file);
  if (!complete) return complete.error();
  return read_trajectory(file);
}

}  // namespace pcavr
