// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/replay.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "pcavr/core/output.hpp"
#include "pcavr/pipeline/known_parameters.hpp"

#include "follow_objects.hpp"
#include "identify_signals.hpp"
#include "survey.hpp"

namespace pcavr {
namespace {

/// A scene pose this near in time is the frame's own [half the format's pairing gap].
constexpr Duration kSameFrame = std::chrono::milliseconds(10);

/// The scene's bodies, with the recording's tags on them and its word on where they start.
Expected<std::vector<MovableBody>> bodies_of(const Recording& recording,
                                             const SceneManifest& scene) {
  std::vector<MovableBody> bodies;
  for (const SceneObjectEntry& object : scene.objects) {
    if (!object.is_movable) continue;
    Expected<CadModel> model = read_cad_model(scene.folder / object.mesh, object.name);
    if (!model) return model.error();
    ObjectEntry entry{.name = object.name,
                      .mesh = object.mesh,
                      .mass = object.mass,
                      .is_movable = true,
                      .T_base_object = object.T_base_object_start};
    bodies.push_back(
        {std::move(entry), std::move(*model), object_placements(recording.manifest, object.name)});
  }
  if (bodies.empty()) {
    return Error{.message = "the scene has no movable object to follow",
                 .file = (scene.folder / "scene.yaml").string()};
  }
  return bodies;
}

/// The camera poses that the scene was built with, if they cover this recording.
std::optional<CameraTrack> camera_of_scene(const Recording& recording, const Trajectory& poses,
                                           const SceneQuality& quality) {
  CameraTrack track;
  track.is_fixed_camera = quality.is_fixed_camera;
  std::size_t placed = 0;
  for (std::size_t i = 0; i < recording.frames.size(); ++i) {
    const Stamp stamp = recording.frames[i].depth_stamp;
    FramePlacement placement;
    placement.frame = i;
    placement.stamp = stamp;
    if (const auto nearest = poses.nearest(stamp, kSameFrame)) {
      placement.status = PlacementStatus::placed;
      placement.T_base_camera = poses.poses()[*nearest].pose;
      placement.position_sigma = quality.camera_position_sigma;
      placement.rotation_sigma = quality.camera_rotation_sigma;
      ++placed;
    }
    track.frames.push_back(placement);
  }
  if (placed != poses.size() || placed == 0) return std::nullopt;
  return track;
}

Trajectory placed_frames(const CameraTrack& camera) {
  Trajectory placed;
  for (const FramePlacement& frame : camera.frames) {
    if (frame.status == PlacementStatus::placed) placed.append(frame.stamp, frame.T_base_camera);
  }
  return placed;
}

TrackedPose tracked_pose_of(const ObjectObservation& seen) {
  return {seen.stamp.seconds(), seen.T_base_object,
          std::sqrt(seen.covariance.topLeftCorner<3, 3>().trace()),
          std::sqrt(seen.covariance.bottomRightCorner<3, 3>().trace())};
}

void warn_of_unseen(const Replay& replay, const Observer& observer) {
  for (const ReplayedObject& object : replay.objects) {
    const bool is_seen = std::any_of(
        object.observations.begin(), object.observations.end(),
        [](const ObjectObservation& seen) { return seen.evidence != ObjectEvidence::none; });
    if (!is_seen) {
      observer.on_warning(object.name +
                          " was not seen in any frame: are its tags in the recording's manifest?");
    }
  }
}

/// Tracking that was done before, for the scene's bodies.
Expected<Replay> tracking_from(const std::filesystem::path& folder,
                               const std::vector<MovableBody>& bodies) {
  Replay replay;
  replay.tracked_folder = folder;
  bool has_any = false;
  for (const MovableBody& body : bodies) {
    Expected<std::vector<TrackedPose>> tracked = read_tracked_poses(folder, body.entry.name);
    if (!tracked) return tracked.error();
    has_any = has_any || !tracked->empty();
    replay.objects.push_back({body.entry.name, {}, std::move(*tracked)});
  }
  if (!has_any) {
    return Error{.message = "no objects/NAME/tracked.txt of the scene's objects",
                 .file = folder.string(),
                 .hint = "name a run, or the folder tracked of a simulated recording"};
  }
  return replay;
}

Expected<Replay> track(const Recording& recording, const SceneManifest& scene,
                       const std::vector<MovableBody>& bodies, const ReplayOptions& options,
                       const Observer& observer) {
  if (options.tracked) {
    Expected<Replay> replay = tracking_from(*options.tracked, bodies);
    if (!replay || recording.frames.empty()) return replay;
    const Expected<Trajectory> camera = read_trajectory(scene.folder / "camera_trajectory.txt");
    if (!camera) return camera.error();
    const auto known = camera_of_scene(recording, *camera, scene.quality);
    if (known) replay->camera_trajectory = placed_frames(*known);
    return replay;
  }
  const bool has_images = recording.manifest.camera && !recording.frames.empty();
  if (has_images || recording.tool.empty()) {
    return replay_tracking(recording, scene, options, observer);
  }
  observer.on_warning("the recording holds no images: objects are predicted, and never seen");
  Replay replay;
  for (const MovableBody& body : bodies) replay.objects.push_back({body.entry.name, {}, {}});
  return replay;
}

Expected<TeleopInput> teleop_input(const Recording& recording, const SceneManifest& scene,
                                   const std::vector<MovableBody>& bodies, const Replay& replay,
                                   const ParameterTable& known) {
  TeleopInput input;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const MovableBody& body = bodies[i];
    input.objects.push_back({body.entry.name, body.model, *body.entry.T_base_object,
                             known.at(body.entry.name), replay.objects[i].tracked});
  }
  // A scene of a recording without images is what the manifest stated: nothing was scanned.
  if (scene.quality.frames_used > 0) {
    Expected<TriangleMesh> mesh = read_mesh(scene.folder / "mesh.ply");
    if (!mesh) return mesh.error();
    input.static_mesh_base = std::move(*mesh);
  }
  input.tool_radius = recording.manifest.tool_radius.value_or(input.tool_radius);
  for (const TimedPose& tool : recording.tool.poses()) {
    input.t_tool.push_back(tool.stamp.seconds());
    input.p_base_tip.push_back(tool.pose.translation());
  }
  for (const WrenchSample& sample : recording.wrench) {
    input.t_force.push_back(sample.stamp.seconds());
    input.force_base.push_back(sample.force);
  }
  if (input.t_tool.size() > 1 && !input.t_force.empty()) {
    const Segmentation contacts =
        segment_contacts(input.t_force, input.force_base, input.t_tool, input.p_base_tip);
    input.tool_to_force =
        force_offset(contacts, input.t_force, PathView(input.t_tool, input.p_base_tip));
  }
  return input;
}

}  // namespace

Expected<Replay> replay_recording(const Recording& recording, const SceneManifest& scene,
                                  const ReplayOptions& options, const Observer& observer) {
  const Expected<std::vector<MovableBody>> bodies = bodies_of(recording, scene);
  if (!bodies) return bodies.error();
  const Expected<ParameterTable> known =
      known_parameters(scene, options.parameters, options.parameters_file);
  if (!known) return known.error();
  Expected<Replay> replay = track(recording, scene, *bodies, options, observer);
  if (!replay || recording.tool.empty()) return replay;
  StageClock clock;
  clock.begin("both sites");
  Expected<TeleopInput> input = teleop_input(recording, scene, *bodies, *replay, *known);
  if (!input) return input.error();
  Expected<TeleopRun> run = run_teleop(*input, options.teleop, observer);
  if (!run) return run.error();
  clock.end();
  replay->teleop = std::move(*run);
  replay->parameters_file = options.parameters ? options.parameters_file : "none";
  replay->teleop_options = options.teleop;
  const std::vector<StageTime> times = clock.times();
  replay->times.insert(replay->times.end(), times.begin(), times.end());
  return replay;
}

Expected<Replay> replay_tracking(const Recording& recording, const SceneManifest& scene,
                                 const ReplayOptions& options, const Observer& observer) {
  if (!recording.manifest.camera || recording.frames.empty()) {
    return Error{.message = "the recording holds no frames to track objects in",
                 .file = recording.folder.string()};
  }
  StageClock clock;
  const SurveyOptions survey_options{.depth_noise = options.depth_noise,
                                     .trust_poses = options.trust_poses,
                                     .skip_bad = options.skip_bad,
                                     .parallelism = options.parallelism};
  const Expected<std::vector<MovableBody>> bodies = bodies_of(recording, scene);
  if (!bodies) return bodies.error();
  const Expected<Trajectory> scene_camera = read_trajectory(scene.folder / "camera_trajectory.txt");
  if (!scene_camera) return scene_camera.error();

  clock.begin("tags and camera");
  Replay replay;
  std::optional<CameraTrack> known = camera_of_scene(recording, *scene_camera, scene.quality);
  replay.camera_from_scene = known.has_value();
  Expected<Survey> survey =
      survey_recording(recording, *bodies, survey_options, observer, std::move(known));
  if (!survey) return survey.error();

  clock.begin("objects");
  for (const MovableBody& body : *bodies) replay.objects.push_back({body.entry.name, {}});
  const Expected<void> done = follow_objects(
      recording, *bodies, *survey, survey_options, observer, [&](const FollowedFrame& followed) {
        ++replay.frames_used;
        for (std::size_t i = 0; i < replay.objects.size(); ++i) {
          const ObjectObservation& seen = followed.objects[i];
          replay.objects[i].observations.push_back(seen);
          if (seen.evidence != ObjectEvidence::none) {
            replay.objects[i].tracked.push_back(tracked_pose_of(seen));
          }
        }
      });
  if (!done) return done.error();
  warn_of_unseen(replay, observer);
  clock.end();
  replay.frames_recorded = recording.frames.size() + recording.unpaired_color;
  replay.frames_dropped = dropped_frames(recording, *survey);
  replay.camera_trajectory = placed_frames(survey->camera);
  replay.times = clock.times();
  return replay;
}

}  // namespace pcavr
