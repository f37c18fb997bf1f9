// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "scene_from_manifest.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include "pcavr/base/core/median.hpp"
#include "pcavr/pipeline/known_parameters.hpp"
#include "pcavr/pipeline/replay.hpp"

#include "follow_objects.hpp"
#include "pipeline/checks/consistency_checks.hpp"

namespace pcavr {
namespace {

/// Bodies whose lowest points differ by less than this in height are on one plane [m].
constexpr double kSamePlane = 0.002;
/// Margin of a support plane around the objects on it and the tool's path [m].
constexpr double kMargin = 0.1;

Error missing_pose_error(const Recording& recording, const std::string& name) {
  return {
      .message = name.empty() ? "the recording has no frames"
                              : "no frames, and no pose is stated for object " + name,
      .file = recording.folder.string(),
      .hint =
          "a scene needs colour and depth images (rgb.txt and depth.txt with at least one "
          "pair within 20 ms), or a pose in recording.yaml or tracked/ for every movable object"};
}

/// Takes the first pose in the recording's own tracked/ if the manifest states none.
Expected<void> place_by_tracking(const Recording& recording, ObjectEntry& entry) {
  const auto folder = tracked_folder_of(recording, {});
  if (entry.T_base_object || !folder) return {};
  const Expected<TrackedFile> tracked =
      read_tracked_poses(*folder, entry.name, {.T_tracked_object = entry.T_tracked_object});
  if (!tracked) return tracked.error();
  if (!tracked->poses.empty()) entry.T_base_object = tracked->poses.front().T_base_object;
  return {};
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

}  // namespace

Scene empty_scene(const Recording& recording, double voxel_size,
                  const OccupancyOptions& occupancy) {
  return {.mesh_base = {},
          .levels_of_detail_base = {TriangleMesh{}},
          .cloud_base = {},
          .occupancy = OccupancyMap(occupancy),
          .support_planes = {},
          .objects = {},
          .robot = {},
          .tags = scene_tags(recording.manifest),
          .camera_trajectory = {},
          .quality = {},
          .recording = recording.folder.string(),
          .voxel_size = voxel_size};
}

SceneObject scene_object_at_stated_pose(const DeclaredBody& body) {
  SceneObject object;
  object.model = body.model;
  object.T_base_object = object.T_base_object_start = *body.entry.T_base_object;
  object.evidence = kByManifest;
  object.mass = body.entry.mass;
  object.is_movable = body.entry.is_movable;
  return object;
}

void add_at_stated_pose(const Manifest& manifest, const DeclaredBody& body, Scene& scene) {
  SceneObject& object = scene.objects.emplace_back(scene_object_at_stated_pose(body));
  object.hertz_stiffness = hertz_stiffness_of(manifest, body.entry);
  if (object.is_movable) return;
  scene.occupancy.mark_occupied(transformed(object.T_base_object, object.model.mesh_object));
}

std::vector<SupportPlane> horizontal_planes(const std::vector<SceneObject>& objects,
                                            const Trajectory& tool) {
  std::vector<SupportPlane> planes;
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const SceneObject& object : objects) {
    if (!object.is_movable || object.evidence == kNotSeen) continue;
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

SceneObject scene_object_of_track(const DeclaredBody& body,
                                  const std::vector<ObjectObservation>& track) {
  SceneObject object;
  object.model = body.model;
  object.evidence = kNotSeen;
  object.mass = body.entry.mass;
  object.is_movable = body.entry.is_movable;
  std::vector<double> translations;
  std::vector<double> rotations;
  const ObjectObservation* first = nullptr;
  const ObjectObservation* last = nullptr;
  bool still_at_start = true;
  for (const ObjectObservation& seen : track) {
    if (seen.evidence == ObjectEvidence::none) continue;
    // While the object rests at its start, each observation is more accurate than the previous one.
    still_at_start = still_at_start && (seen.is_at_rest || first == nullptr || !first->is_at_rest);
    if (first == nullptr || (still_at_start && seen.is_at_rest)) first = &seen;
    last = &seen;
    if (seen.evidence != ObjectEvidence::tags_and_shape) continue;
    translations.push_back(seen.refinement_translation);
    rotations.push_back(seen.refinement_rotation);
  }
  if (last == nullptr) {
    if (body.entry.T_base_object) {
      object.evidence = kByManifest;
      object.T_base_object = object.T_base_object_start = *body.entry.T_base_object;
    }
    return object;
  }
  object.T_base_object_start = first->T_base_object;
  object.T_base_object = last->T_base_object;
  object.evidence = evidence_name(last->evidence);
  object.position_std = std::sqrt(last->covariance.topLeftCorner<3, 3>().trace());
  object.rotation_std = std::sqrt(last->covariance.bottomRightCorner<3, 3>().trace());
  object.refinement_translation = median(std::move(translations));
  object.refinement_rotation = median(std::move(rotations));
  return object;
}

void report_not_found(const Recording& recording, const Survey& survey, const DeclaredBody& body,
                      const BodyPoseOptions& options, const Observer& observer,
                      SceneObject& object) {
  if (object.evidence != kNotSeen) return;
  object.reason = explain_not_found(recording, survey, body, options);
  observer.on_warning(NotFoundObject{body.entry.name, object.reason}.to_string());
}

Expected<Scene> scene_from_manifest(const Recording& recording, double voxel_size,
                                    const OccupancyOptions& occupancy,
                                    const PerceptionOptions& perception) {
  Expected<std::vector<DeclaredBody>> bodies = load_movable_bodies(recording, perception.cad);
  if (!bodies) return bodies.error();
  Expected<std::vector<DeclaredBody>> immovable = load_immovable_bodies(recording, perception.cad);
  if (!immovable) return immovable.error();
  if (bodies->empty() && immovable->empty() && !recording.manifest.robot)
    return missing_pose_error(recording, {});
  std::move(immovable->begin(), immovable->end(), std::back_inserter(*bodies));
  for (const DeclaredBody& body : *bodies) {
    const auto findings = check_body(recording.manifest, body.entry, body.model,
                                     SurfaceQuery(body.model.mesh_object), perception.consistency);
    if (has_contradiction(findings)) return contradiction_error(recording, findings);
  }
  Scene scene = empty_scene(recording, voxel_size, occupancy);
  scene.quality.left_out = recording.left_out;
  for (DeclaredBody& body : *bodies) {
    if (Expected<void> placed = place_by_tracking(recording, body.entry); !placed) {
      return placed.error();
    }
    if (!body.entry.T_base_object) return missing_pose_error(recording, body.entry.name);
    add_at_stated_pose(recording.manifest, body, scene);
  }
  scene.support_planes = horizontal_planes(scene.objects, recording.tool);
  return scene;
}

}  // namespace pcavr
