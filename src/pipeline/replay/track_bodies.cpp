// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "track_bodies.hpp"

#include <cmath>
#include <cstddef>
#include <filesystem>
#include <iterator>
#include <optional>
#include <string>
#include <utility>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/geometry/pose_outliers.hpp"
#include "pcavr/perception/tracking/object_tracker.hpp"

#include "pipeline/build/follow_objects.hpp"
#include "pipeline/build/scene_bodies.hpp"
#include "pipeline/checks/clock_checks.hpp"
#include "pipeline/checks/tracked_start.hpp"
#include "run_writer.hpp"

namespace pcavr {
namespace {

/// A scene pose within this time belongs to the frame [half the format's pairing tolerance].
constexpr Duration kSameFrame = std::chrono::milliseconds(10);

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
      placement.position_std = quality.camera_position_std;
      placement.rotation_std = quality.camera_rotation_std;
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

void warn_of_unseen(const Recording& recording, const Survey& survey, const Replay& replay,
                    const BodyPoseOptions& options, const Observer& observer) {
  for (const ReplayedObject& object : replay.objects) {
    if (!object.tracked.empty()) continue;
    const std::string rejected =
        explain_rejected_tags(recording, survey.detections, object.name, options);
    observer.on_warning(rejected.empty()
                            ? object.name +
                                  " was not detected in any frame: check that its tags are in the "
                                  "recording's manifest"
                            : object.name + " has no pose: " + rejected + "; " + kRejectedTagsHint);
  }
}

void leave_out_outliers(Replay& replay, const Observer& observer) {
  for (ReplayedObject& object : replay.objects) {
    const PoseOutliers outliers = remove_pose_outliers(object.tracked);
    if (outliers.count == 0) continue;
    observer.on_warning("tracking of " + object.name + ": " + describe(outliers) + " (" +
                        std::to_string(outliers.count) + ")");
  }
}

std::vector<ReplayedObject> replayed_objects(const std::vector<DeclaredBody>& bodies) {
  std::vector<ReplayedObject> objects;
  for (const DeclaredBody& body : bodies) {
    ReplayedObject& object = objects.emplace_back();
    object.name = body.entry.name;
    object.simplification = body.model.simplification;
  }
  return objects;
}

/// Stores each frame's observations in the replay, or streams them to its folder.
class TrackingSink {
 public:
  explicit TrackingSink(Replay& replay) : replay_(replay) {}

  Expected<void> open() {
    if (!replay_.run_folder) return {};
    return writer_.open(*replay_.run_folder, object_names(replay_));
  }
  void add(const FollowedFrame& followed) {
    ++replay_.frames_used;
    for (std::size_t i = 0; i < replay_.objects.size(); ++i) {
      const ObjectObservation& seen = followed.objects[i];
      ReplayedObject& object = replay_.objects[i];
      ++object.frames_by_evidence[seen.evidence];
      if (seen.evidence != ObjectEvidence::none) object.tracked.push_back(tracked_pose_of(seen));
      if (!replay_.run_folder) {
        object.observations.push_back(seen);
      } else if (written_) {
        written_ = writer_.add(i, seen);
      }
    }
  }
  Expected<void> close() {
    if (!written_ || !replay_.run_folder) return written_;
    return writer_.close();
  }

 private:
  Replay& replay_;
  TrackingWriter writer_;
  Expected<void> written_;  ///< the first failure
};

/// Reads earlier tracking of the scene's bodies.
Expected<Replay> read_tracking(const Recording& recording, const std::filesystem::path& folder,
                               const std::vector<DeclaredBody>& bodies, bool skip_bad,
                               const Observer& observer) {
  Replay replay;
  replay.tracked_folder = folder;
  bool has_any = false;
  replay.objects = replayed_objects(bodies);
  for (ReplayedObject& object : replay.objects) {
    Expected<TrackedFile> tracked =
        read_tracked_poses(folder, object.name,
                           {.skip_bad = skip_bad,
                            .T_tracked_object = tracked_to_object(recording, folder, object.name)});
    if (!tracked) return tracked.error();
    if (tracked->note) observer.on_note(*tracked->note);
    has_any = has_any || !tracked->poses.empty();
    object.tracked = std::move(tracked->poses);
    warn_of_tracked_clock(recording, object.name, object.tracked, Stamp{}, observer);
    std::move(tracked->left_out.begin(), tracked->left_out.end(),
              std::back_inserter(replay.left_out));
  }
  if (!has_any && !bodies.empty()) {
    return Error{.message = "no objects/NAME/tracked.txt of the scene's objects",
                 .file = folder.string(),
                 .hint = "give a run, or the folder tracked of a simulated recording"};
  }
  return replay;
}

/// `bodies` and the replay's objects are in the same order.
std::vector<TrackedStart> tracked_starts(const std::filesystem::path& folder,
                                         const std::vector<DeclaredBody>& bodies,
                                         const Replay& replay) {
  std::vector<TrackedStart> starts;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const std::vector<TrackedPose>& tracked = replay.objects[i].tracked;
    const std::optional<Pose>& stated = bodies[i].entry.T_base_object;
    if (tracked.empty() || !stated) continue;
    starts.push_back({bodies[i].entry.name,
                      (folder / "objects" / bodies[i].entry.name / "tracked.txt").string(), *stated,
                      tracked.front().T_base_object});
  }
  return starts;
}

/// Tracks the bodies through the recording's images.
Expected<Replay> track_by_images(const Recording& recording, const SceneManifest& scene,
                                 const std::vector<DeclaredBody>& bodies,
                                 const ReplayOptions& options, const Observer& observer) {
  if (!recording.manifest.camera || recording.frames.empty()) {
    return Error{.message = "the recording has no images to track objects in",
                 .file = recording.folder.string()};
  }
  StageClock clock;
  const SurveyOptions survey_options{.perception = options.perception,
                                     .trust_poses = options.trust_poses,
                                     .skip_bad = options.skip_bad,
                                     .parallelism = options.parallelism};
  const Expected<Trajectory> scene_camera = read_camera_trajectory(scene);
  if (!scene_camera) return scene_camera.error();
  if (!scene.lines) {
    observer.on_warning((scene.folder / "scene.yaml").string() +
                        ": written by an older version, without line counts: a truncation of "
                        "camera_trajectory.txt between two lines can't be detected");
  }

  clock.begin("tags and camera");
  Replay replay;
  std::optional<CameraTrack> known = camera_of_scene(recording, *scene_camera, scene.quality);
  replay.camera_from_scene = known.has_value();
  Expected<Survey> survey =
      survey_recording(recording, bodies, survey_options, observer, std::move(known));
  if (!survey) return survey.error();

  clock.begin("objects");
  replay.objects = replayed_objects(bodies);
  replay.run_folder = options.run_folder;
  TrackingSink tracking(replay);
  if (const Expected<void> opened = tracking.open(); !opened) return opened.error();
  const Expected<void> done =
      follow_objects(recording, bodies, *survey, survey_options, observer,
                     [&](const FollowedFrame& followed) { tracking.add(followed); });
  if (!done) return done.error();
  if (const Expected<void> closed = tracking.close(); !closed) return closed.error();
  warn_of_unseen(recording, *survey, replay, options.perception.body_pose, observer);
  leave_out_outliers(replay, observer);
  clock.end();
  replay.frames_recorded = recording.frames.size() + recording.unpaired_color;
  replay.frames_dropped = dropped_frames(recording, *survey);
  replay.camera_trajectory = placed_frames(survey->camera);
  replay.times = clock.times();
  return replay;
}

}  // namespace

Expected<Replay> track_bodies(const Recording& recording, const SceneManifest& scene,
                              const std::vector<DeclaredBody>& movable,
                              const ReplayOptions& options, const Observer& observer) {
  if (const auto folder = tracked_folder_of(recording, options.tracked)) {
    Expected<Replay> replay =
        read_tracking(recording, *folder, movable, options.skip_bad, observer);
    if (!replay) return replay;
    const Expected<void> accepted =
        accept_tracked_starts(tracked_starts(*folder, movable, *replay), observer);
    if (!accepted) return accepted.error();
    if (recording.frames.empty()) return replay;
    const Expected<Trajectory> camera = read_camera_trajectory(scene);
    if (!camera) return camera.error();
    const auto known = camera_of_scene(recording, *camera, scene.quality);
    if (known) replay->camera_trajectory = placed_frames(*known);
    return replay;
  }
  if (movable.empty()) return Replay();
  const bool has_images = recording.manifest.camera && !recording.frames.empty();
  if (has_images || recording.tool.empty()) {
    return track_by_images(recording, scene, movable, options, observer);
  }
  observer.on_warning("the recording has no images: objects are predicted without tracking");
  Replay replay;
  replay.objects = replayed_objects(movable);
  return replay;
}

void add_immovable(const std::vector<DeclaredBody>& bodies, Replay& replay) {
  for (ReplayedObject& object : replayed_objects(bodies)) {
    object.is_movable = false;
    replay.objects.push_back(std::move(object));
  }
}

Expected<Replay> replay_tracking(const Recording& recording, const SceneManifest& scene,
                                 const ReplayOptions& options, const Observer& observer) {
  const Expected<std::vector<DeclaredBody>> bodies = read_movable_bodies(recording, scene);
  if (!bodies) return bodies.error();
  return track_by_images(recording, scene, *bodies, options, observer);
}

}  // namespace pcavr
