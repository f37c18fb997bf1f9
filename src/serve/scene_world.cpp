// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/scene_world.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <optional>
#include <string>
#include <utility>

#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/perception/scene/glb_file.hpp"
#include "pcavr/perception/scene/scene.hpp"
#include "pcavr/physics/prediction/body_physics.hpp"
#include "pcavr/pipeline/known_parameters.hpp"
#include "pcavr/pipeline/scanned_surface.hpp"

#include "scene_level.hpp"
#include "serve/tool_start.hpp"

namespace pcavr {
namespace {

Expected<TriangleMesh> static_mesh(const SceneManifest& scene, int max_triangles,
                                   SceneWorld& world) {
  if (!scene.is_scanned()) return TriangleMesh{};
  Expected<TriangleMesh> mesh = read_mesh(scene.folder / "mesh.ply");
  const std::string limit = std::to_string(max_triangles) + " triangles";
  // Level 0 is for display only, and contains the objects too.
  for (std::size_t i = 1; mesh && std::ssize(mesh->triangles) > max_triangles; ++i) {
    if (i >= scene.levels_of_detail.size()) {
      return Error{.message = "more than " + limit + ", and no coarser level of detail",
                   .file = (scene.folder / "mesh.ply").string(),
                   .hint = "build the scene again with a larger --voxel"};
    }
    world.notes.push_back("using " + scene.levels_of_detail[i].string() +
                          " for contact: mesh.ply has more than " + limit);
    mesh = read_scene_level(scene.folder / scene.levels_of_detail[i]);
  }
  return mesh;
}

Expected<void> add_object(const SceneManifest& scene, const SceneObjectEntry& object,
                          const ParameterTable& known, const SceneWorldOptions& options,
                          SceneWorld& world) {
  Expected<CadModel> model = read_object_model(scene, object);
  if (!model) return model.error();
  const auto complete = object.is_movable ? complete_physics : complete_immovable_physics;
  CompletedPhysics completed = complete(known.at(object.name), *model, object.T_base_object,
                                        world.model.world.gravity, options.unknown_objects);
  if (object.is_movable) {
    world.full_scale_force =
        std::max(world.full_scale_force, completed.physics.friction.limiting_force);
  } else {
    remove_surface_of(transformed(object.T_base_object, model->mesh_object),
                      world.model.world.static_mesh_base);
  }
  world.assumed.push_back({object.name, std::move(completed.assumed)});
  world.model.world.bodies.push_back(
      {std::move(*model), object.T_base_object, completed.physics, object.is_movable});
  return {};
}

void append(const TriangleMesh& part, TriangleMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), part.vertices.begin(), part.vertices.end());
  for (const auto& triangle : part.triangles) {
    mesh.triangles.push_back({triangle[0] + first, triangle[1] + first, triangle[2] + first});
  }
}

Expected<void> add_guards(const SceneManifest& scene, SceneWorld& world) {
  for (const GuardSurface& guard : scene.guards) {
    const Expected<TriangleMesh> mesh = guard_mesh(guard, scene.folder);
    if (!mesh) return mesh.error();
    append(*mesh, world.model.guard_mesh_base);
  }
  return {};
}

/// An Error where the tool would start inside a guard.
Expected<void> check_start(const SceneManifest& scene, const SceneWorld& world) {
  for (const GuardSurface& guard : scene.guards) {
    const Expected<bool> is_inside =
        is_guarded(guard, scene.folder, world.p_base_tool_start, world.model.world.tool_radius);
    if (!is_inside) return is_inside.error();
    if (!*is_inside) continue;
    return Error{.message = "guard " + guard.name + " encloses the tool's start",
                 .file = (scene.folder / "scene.yaml").string(),
                 .place = "guards",
                 .hint = "make the guard smaller, or raise serve.scene.start_height"};
  }
  return {};
}

/// Half way from the first camera to the scan in the middle of its picture: in the page's first
/// view.
std::optional<Eigen::Vector3d> start_before_scan(const SceneManifest& scene,
                                                 const TriangleMesh& static_mesh_base) {
  const Expected<Trajectory> cameras = read_camera_trajectory(scene);
  if (!cameras || cameras->empty()) return std::nullopt;
  const Pose& T_base_camera = cameras->poses().front().pose;
  const Eigen::Vector3d axis = T_base_camera.rotation() * Eigen::Vector3d::UnitZ();
  const auto hit = SurfaceQuery(static_mesh_base)
                       .cast(T_base_camera.translation().cast<float>(), axis.cast<float>());
  if (!hit) return std::nullopt;
  return T_base_camera.translation() + 0.5 * static_cast<double>(hit->distance) * axis;
}

/// Start above the middle of the bodies; without any in front of the scan, or above it.
Eigen::Vector3d start_above_bodies(const SceneManifest& scene, const WorldModel& world,
                                   double start_height) {
  if (world.bodies.empty() && !world.static_mesh_base.triangles.empty()) {
    if (const auto start = start_before_scan(scene, world.static_mesh_base)) return *start;
  }
  Eigen::AlignedBox3f box;
  for (const WorldBody& body : world.bodies) {
    box.extend(bounds(transformed(body.T_base_object, body.model.mesh_object).vertices));
  }
  if (box.isEmpty()) box = bounds(world.static_mesh_base.vertices);
  if (box.isEmpty()) return Eigen::Vector3d::Zero();
  const Eigen::Vector3f middle = box.center();
  return {middle.x(), middle.y(), box.max().z() + start_height};
}

/// Start beside a body, where a level motion pushes it. An arm starts above the bodies: its links
/// need more room than the tip.
Eigen::Vector3d tool_start(const SceneManifest& scene, const SceneWorldOptions& options,
                           const HapticWorldModel& model) {
  const auto is_in_guard = [&](const Eigen::Vector3d& place) {
    return std::any_of(scene.guards.begin(), scene.guards.end(), [&](const GuardSurface& guard) {
      const auto is_inside = is_guarded(guard, scene.folder, place, options.tool_radius);
      return is_inside && *is_inside;
    });
  };
  std::optional<Eigen::Vector3d> beside;
  if (!scene.robot) beside = tool_start_beside_body(model, options.start_clearance, is_in_guard);
  return beside.value_or(start_above_bodies(scene, model.world, options.start_height));
}

}  // namespace

Expected<TriangleMesh> read_scene_level(const std::filesystem::path& file) {
  const Expected<GlbContent> glb = read_glb(file);
  if (!glb) return glb.error();
  Expected<TriangleMesh> mesh_viewer = read_mesh(file);
  if (!mesh_viewer) return mesh_viewer;
  return transformed(glb->T_viewer_root.inverse(), *mesh_viewer);
}

Expected<SceneWorld> make_scene_world(const SceneManifest& scene,
                                      const SceneWorldOptions& options) {
  const Expected<ParameterTable> known =
      known_parameters(scene, options.parameters, options.parameters_file);
  if (!known) return known.error();
  SceneWorld world;
  world.full_scale_force = options.min_full_scale_force;
  Expected<TriangleMesh> mesh = static_mesh(scene, options.max_triangles, world);
  if (!mesh) return mesh.error();
  world.model.world.static_mesh_base = {
      std::move(mesh->vertices), {}, {}, std::move(mesh->triangles)};
  world.model.world.tool_radius = options.tool_radius;
  world.model.world.options = options.world;
  world.model.options = options.haptics;
  world.model.force = options.force;
  for (const NotFoundObject& object : scene.not_found) {
    world.notes.push_back(object.to_string());
  }
  for (const SceneObjectEntry& object : scene.objects) {
    const Expected<void> added = add_object(scene, object, *known, options, world);
    if (!added) return added.error();
  }
  for (const SupportPlane& plane : scene.support_planes) {
    world.model.supports_base.push_back(plane.outline_base);
  }
  world.triangles = world.model.world.static_mesh_base.triangles.size();
  const Expected<void> guarded = add_guards(scene, world);
  if (!guarded) return guarded.error();
  world.p_base_tool_start = tool_start(scene, options, world.model);
  const Expected<void> started = check_start(scene, world);
  if (!started) return started.error();
  return world;
}

}  // namespace pcavr
