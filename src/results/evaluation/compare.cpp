// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "pcavr/base/geometry/matched_poses.hpp"

#include "evaluated_recording.hpp"
#include "findings.hpp"

namespace pcavr {
namespace {

Error no_time_in_common(const ComparisonSide& reference, const ComparisonSide& subject,
                        const std::string& what, const Trajectory& reference_poses,
                        const Trajectory& estimate) {
  const auto span = [](const Trajectory& poses) {
    return format_stamp(poses.poses().front().stamp) + " to " +
           format_stamp(poses.poses().back().stamp) + " s";
  };
  return {.message = "has no pose of " + what + " within the time span of " +
                     reference.folder.string() + " (" + span(estimate) +
                     "; reference: " + span(reference_poses) + ")",
          .file = subject.folder.string(),
          .hint = "compare with the truth of the recording it was made from"};
}

Error nothing_in_common(const ComparisonSide& reference, const ComparisonSide& subject) {
  const auto contents = [](const ComparisonSide& side) {
    return std::string(side.camera.empty() ? "no camera" : "a camera") + ", " +
           std::to_string(side.tracked.size() + side.placed.size()) + " objects, " +
           (side.surface_base ? "a surface" : "no surface");
  };
  return {.message = "has nothing in common with " + reference.folder.string() + ": " +
                     contents(subject) + "; reference: " + contents(reference),
          .file = subject.folder.string(),
          .hint = "compare with the truth of the recording it was made from"};
}

Expected<void> compare_cameras(const ComparisonSide& reference, const ComparisonSide& subject,
                               const EvaluationOptions& options, Findings& findings) {
  if (reference.camera.empty() || subject.camera.empty()) return {};
  CameraFindings camera{reference.camera, subject.camera,
                        trajectory_errors(reference.camera, subject.camera, options.trajectories)};
  if (camera.errors.absolute.empty()) {
    return no_time_in_common(reference, subject, "the camera", camera.reference, camera.estimate);
  }
  findings.camera = std::move(camera);
  return {};
}

Expected<void> compare_object(const ComparisonSide& reference, const ComparisonSide& subject,
                              const std::string& name, const std::string& source,
                              const Trajectory& estimate, const EvaluatedRecording& recording,
                              const EvaluationOptions& options, Parallelism parallelism,
                              Findings& findings) {
  const auto true_poses = reference.tracked.find(name);
  if (true_poses == reference.tracked.end()) return {};
  ObjectFindings object{
      .name = name,
      .source = source,
      .reference = true_poses->second,
      .estimate = estimate,
      .errors = trajectory_errors(true_poses->second, estimate, options.trajectories)};
  if (object.errors.absolute.empty()) {
    return no_time_in_common(reference, subject, name, object.reference, estimate);
  }
  std::vector<Eigen::Vector3f> vertices_object;
  const auto mesh = recording.meshes_object.find(name);
  if (mesh != recording.meshes_object.end()) {
    vertices_object = mesh->second.vertices;
    object.model =
        object_errors(mesh->second, object.reference, estimate, options.trajectories, parallelism);
  }
  std::vector<Stamp> stamps;
  for (const PoseError& error : object.errors.absolute) stamps.push_back(error.stamp);
  object.moving = is_moving(object.reference, vertices_object, stamps, options.motion, parallelism);
  findings.objects.push_back(std::move(object));
  return {};
}

Expected<void> compare_objects(const ComparisonSide& reference, const ComparisonSide& subject,
                               const EvaluatedRecording& recording,
                               const EvaluationOptions& options, Parallelism parallelism,
                               Findings& findings) {
  for (const auto& [source, trajectories] :
       {std::pair{"tracked", &subject.tracked}, {"predicted", &subject.predicted}}) {
    for (const auto& [name, estimate] : *trajectories) {
      const Expected<void> compared = compare_object(reference, subject, name, source, estimate,
                                                     recording, options, parallelism, findings);
      if (!compared) return compared;
    }
  }
  return {};
}

/// Objects of the reference without a pose in the subject.
std::vector<std::string> missing_objects(const ComparisonSide& reference,
                                         const ComparisonSide& subject) {
  std::vector<std::string> missing;
  const auto add_if_missing = [&](const std::string& name) {
    const bool has_pose = subject.tracked.contains(name) || subject.predicted.contains(name) ||
                          subject.placed.contains(name);
    if (!has_pose) missing.push_back(name);
  };
  for (const auto& [name, trajectory] : reference.tracked) add_if_missing(name);
  for (const auto& [name, placement] : reference.placed) {
    if (!reference.tracked.contains(name)) add_if_missing(name);
  }
  return missing;
}

/// The reference's poses of an object at the first and last of the subject's frames.
std::optional<Placement> reference_placement(const ComparisonSide& reference,
                                             const ComparisonSide& subject,
                                             const std::string& name) {
  const auto placed = reference.placed.find(name);
  if (placed != reference.placed.end()) return placed->second;
  const auto tracked = reference.tracked.find(name);
  if (tracked == reference.tracked.end()) return std::nullopt;
  const std::vector<TimedPose>& times =
      subject.camera.empty() ? tracked->second.poses() : subject.camera.poses();
  return Placement{pose_near(tracked->second, times.front().stamp),
                   pose_near(tracked->second, times.back().stamp)};
}

PlacementFindings compare_placement(const std::string& name, const std::string& when,
                                    const Pose& reference, const Pose& estimate,
                                    const EvaluatedRecording& recording) {
  PlacementFindings found{.name = name,
                          .when = when,
                          .translation = translation_distance(reference, estimate),
                          .rotation = rotation_distance(reference, estimate)};
  const auto mesh = recording.meshes_object.find(name);
  if (mesh != recording.meshes_object.end()) {
    found.model = model_error(mesh->second.vertices, reference, estimate);
  }
  return found;
}

void compare_placements(const ComparisonSide& reference, const ComparisonSide& subject,
                        const EvaluatedRecording& recording, Findings& findings) {
  for (const auto& [name, placed] : subject.placed) {
    const std::optional<Placement> truth = reference_placement(reference, subject, name);
    if (!truth) continue;
    findings.placements.push_back(compare_placement(name, "start", truth->T_base_object_start,
                                                    placed.T_base_object_start, recording));
    if (!truth->T_base_object_end || !placed.T_base_object_end) continue;
    findings.placements.push_back(compare_placement(name, "end", *truth->T_base_object_end,
                                                    *placed.T_base_object_end, recording));
  }
}

/// Each movable body that has a mesh, at its reference poses for the stamps.
std::vector<MovedBody> bodies_at(const ComparisonSide& reference,
                                 const EvaluatedRecording& recording,
                                 const std::vector<Stamp>& stamps) {
  std::vector<MovedBody> bodies;
  for (const auto& [name, trajectory] : reference.tracked) {
    const auto mesh = recording.meshes_object.find(name);
    if (mesh == recording.meshes_object.end()) continue;
    MovedBody body{mesh->second, {}};
    for (const Stamp stamp : stamps) body.T_base_object.push_back(pose_near(trajectory, stamp));
    bodies.push_back(std::move(body));
  }
  return bodies;
}

/// All reference poses of the movable bodies.
std::vector<MovedBody> swept_bodies(const ComparisonSide& reference,
                                    const EvaluatedRecording& recording) {
  std::vector<MovedBody> bodies;
  for (const auto& [name, mesh_object] : recording.meshes_object) {
    MovedBody body{mesh_object, {}};
    const auto tracked = reference.tracked.find(name);
    const auto placed = reference.placed.find(name);
    if (tracked != reference.tracked.end()) {
      for (const TimedPose& timed : tracked->second.poses()) {
        body.T_base_object.push_back(timed.pose);
      }
    } else if (placed != reference.placed.end()) {
      body.T_base_object = {placed->second.T_base_object_start};
      if (placed->second.T_base_object_end) {
        body.T_base_object.push_back(*placed->second.T_base_object_end);
      }
    }
    if (!body.T_base_object.empty()) bodies.push_back(std::move(body));
  }
  return bodies;
}

std::optional<Views> views_of(const ComparisonSide& reference, const EvaluatedRecording& recording,
                              const ViewOptions& options) {
  if (!recording.camera || reference.camera.empty()) return std::nullopt;
  Views views;
  views.camera = *recording.camera;
  views.options = options;
  const std::vector<TimedPose>& poses = reference.camera.poses();
  const auto max_views = static_cast<std::size_t>(options.max_views);
  const std::size_t stride = (poses.size() + max_views - 1) / max_views;
  std::vector<Stamp> stamps;
  for (std::size_t i = 0; i < poses.size(); i += stride) {
    views.T_base_camera.push_back(poses[i].pose);
    stamps.push_back(poses[i].stamp);
  }
  views.bodies = bodies_at(reference, recording, stamps);
  return views;
}

void compare_surfaces(const ComparisonSide& reference, const ComparisonSide& subject,
                      const EvaluatedRecording& recording, const EvaluationOptions& options,
                      Parallelism parallelism, Findings& findings) {
  if (!reference.surface_base || !subject.surface_base) return;
  const std::optional<Views> views = views_of(reference, recording, options.views);
  SurfaceFindings surface{.errors = mesh_errors(*reference.surface_base, *subject.surface_base,
                                                views, options.surfaces, parallelism),
                          .views = views ? views->T_base_camera.size() : 0};
  const std::vector<MovedBody> bodies = swept_bodies(reference, recording);
  if (!bodies.empty()) {
    surface.left_behind = share_left_behind(*reference.surface_base, *subject.surface_base, bodies,
                                            options.surfaces, parallelism);
  }
  surface.map = error_map(*reference.surface_base, *subject.surface_base,
                          views ? views->T_base_camera : std::vector<Pose>(),
                          surface.errors.accuracy.p95, parallelism);
  findings.surface = std::move(surface);
}

/// The clock's zero, unless the reference begins so long after it that times would be unreadable.
Stamp origin_of(const Findings& findings) {
  constexpr Duration kLongAgo = std::chrono::seconds(1000);
  std::optional<Stamp> first;
  const auto include = [&](const Trajectory& reference) {
    const Stamp stamp = reference.poses().front().stamp;
    first = first ? std::min(*first, stamp) : stamp;
  };
  if (findings.camera) include(findings.camera->reference);
  for (const ObjectFindings& object : findings.objects) include(object.reference);
  return first && *first - Stamp() > kLongAgo ? *first : Stamp();
}

}  // namespace

Expected<Findings> compare(const ComparisonSide& reference, const ComparisonSide& subject,
                           const EvaluationOptions& options, Parallelism parallelism,
                           const Observer& observer) {
  const Expected<EvaluatedRecording> recording =
      read_evaluated_recording(reference, subject, observer);
  if (!recording) return recording.error();
  Findings findings;
  Expected<void> compared = compare_cameras(reference, subject, options, findings);
  if (!compared) return compared.error();
  compared = compare_objects(reference, subject, *recording, options, parallelism, findings);
  if (!compared) return compared.error();
  compare_placements(reference, subject, *recording, findings);
  compare_surfaces(reference, subject, *recording, options, parallelism, findings);
  if (!findings.camera && findings.objects.empty() && findings.placements.empty() &&
      !findings.surface) {
    return nothing_in_common(reference, subject);
  }
  findings.origin = origin_of(findings);
  compared = add_run(reference, subject, *recording, options.forces, findings);
  if (!compared) return compared.error();
  findings.objects_missing = missing_objects(reference, subject);
  for (const std::string& name : findings.objects_missing) {
    observer.on_warning(name + " has no pose in " + subject.folder.string());
  }
  return findings;
}

}  // namespace pcavr
