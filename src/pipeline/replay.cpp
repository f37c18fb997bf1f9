// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/replay.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "pcavr/core/output.hpp"

#include "follow_objects.hpp"
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

}  // namespace

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
          replay.objects[i].observations.push_back(followed.objects[i]);
        }
      });
  if (!done) return done.error();
  warn_of_unseen(replay, observer);
  clock.end();
  replay.frames_recorded = recording.frames.size() + recording.unpaired_color;
  replay.frames_dropped = dropped_frames(recording, *survey);
  replay.times = clock.times();
  return replay;
}

}  // namespace pcavr
