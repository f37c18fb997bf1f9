// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "scene_from_manifest.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "survey.hpp"

namespace pcavr {
namespace {

/// Bodies whose lowest points differ by less than this in height are on one plane [m].
constexpr double kSamePlane = 0.002;
/// Margin of a support plane around the objects on it and the tool's path [m].
constexpr double kMargin = 0.1;
constexpr Rgb8 kNeutral{150, 150, 150};

Error missing_pose_error(const Recording& recording, const std::string& name) {
  return {.message = name.empty() ? "the recording has no frames"
                                  : "no frames, and no pose is stated for object " + name,
          .file = recording.folder.string(),
          .hint =
              "a scene needs colour and depth images (rgb.txt and depth.txt with at least one "
              "pair within 20 ms), or a pose in recording.yaml for every movable object"};
}

void append(TriangleMesh& mesh, const TriangleMesh& part) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), part.vertices.begin(), part.vertices.end());
  mesh.normals.insert(mesh.normals.end(), part.normals.begin(), part.normals.end());
  mesh.colors.resize(mesh.vertices.size(), kNeutral);
  for (const auto& [a, b, c] : part.triangles) {
    mesh.triangles.push_back({first + a, first + b, first + c});
  }
}

/// The bodies that do not move and have a pose: static collision geometry.
Expected<TriangleMesh> static_bodies(const Recording& recording) {
  TriangleMesh mesh;
  for (const ObjectEntry& object : recording.manifest.objects) {
    if (object.is_movable || object.mesh.empty() || !object.T_base_object) continue;
    const Expected<CadModel> model = read_cad_model(recording.folder / object.mesh, object.name);
    if (!model) return model.error();
    append(mesh, transformed(*object.T_base_object, model->mesh_object));
  }
  return mesh;
}

/// A rectangle around the objects on the plane and the tool's path, counter-clockwise.
std::vector<Eigen::Vector3d> outline_around(Eigen::AlignedBox3d box, const Trajectory& tool) {
  const double height = box.min().z();
  for (const TimedPose& pose : tool.poses()) box.extend(pose.pose.translation());
  const double x0 = box.min().x() - kMargin;
  const double x1 = box.max().x() + kMargin;
  const double y0 = box.min().y() - kMargin;
  const double y1 = box.max().y() + kMargin;
  return {{x0, y0, height}, {x1, y0, height}, {x1, y1, height}, {x0, y1, height}};
}

std::vector<SupportPlane> horizontal_planes(const std::vector<SceneObject>& objects,
                                            const Trajectory& tool) {
  std::vector<SupportPlane> planes;
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const SceneObject& object : objects) {
    const TriangleMesh mesh_base = transformed(object.T_base_object, object.model.mesh_object);
    const Eigen::AlignedBox3d box = bounds(mesh_base.vertices).cast<double>();
    const double height = box.min().z();
    const auto known = std::find_if(planes.begin(), planes.end(), [&](const SupportPlane& plane) {
      return std::abs(plane.plane_base.offset - height) < kSamePlane;
    });
    const auto i = static_cast<std::size_t>(known - planes.begin());
    if (known == planes.end()) {
      planes.push_back({.plane_base = {Eigen::Vector3d::UnitZ(), height},
                        .outline_base = {},
                        .rms = 0.0,
                        .objects = {}});
      boxes.push_back(box);
    }
    boxes[i].extend(box);
    planes[i].objects.push_back(object.model.name);
  }
  for (std::size_t i = 0; i < planes.size(); ++i) {
    planes[i].outline_base = outline_around(boxes[i], tool);
  }
  return planes;
}

}  // namespace

Expected<Scene> scene_from_manifest(const Recording& recording, double voxel_size,
                                    const OccupancyOptions& occupancy, const CadOptions& cad) {
  Expected<std::vector<MovableBody>> bodies = load_movable_bodies(recording, cad);
  if (!bodies) return bodies.error();
  if (bodies->empty()) return missing_pose_error(recording, {});
  Expected<TriangleMesh> mesh = static_bodies(recording);
  if (!mesh) return mesh.error();
  Scene scene{.mesh_base = std::move(*mesh),
              .levels_of_detail_base = {},
              .cloud_base = {},
              .occupancy = OccupancyMap(occupancy),
              .support_planes = {},
              .objects = {},
              .tags = scene_tags(recording.manifest),
              .camera_trajectory = {},
              .quality = {},
              .recording = recording.folder.string(),
              .voxel_size = voxel_size};
  scene.quality.left_out = recording.left_out;
  scene.occupancy.mark_occupied(scene.mesh_base);
  for (MovableBody& body : *bodies) {
    if (!body.entry.T_base_object) return missing_pose_error(recording, body.entry.name);
    SceneObject object;
    object.model = std::move(body.model);
    object.T_base_object = object.T_base_object_start = *body.entry.T_base_object;
    object.evidence = kByManifest;
    object.mass = body.entry.mass;
    object.is_movable = true;
    scene.objects.push_back(std::move(object));
  }
  scene.levels_of_detail_base.push_back(scene.mesh_base);
  scene.support_planes = horizontal_planes(scene.objects, recording.tool);
  return scene;
}

}  // namespace pcavr
