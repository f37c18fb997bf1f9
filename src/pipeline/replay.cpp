// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/replay.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <span>
#include <utility>

#include "pcavr/core/output.hpp"
#include "pcavr/pipeline/known_parameters.hpp"
#include "pcavr/pipeline/scanned_surface.hpp"
#include "pcavr/recording/stream_clocks.hpp"

#include "clock_checks.hpp"
#include "follow_objects.hpp"
#include "run_writer.hpp"
#include "survey.hpp"

namespace pcavr {
namespace {

/// A scene pose within this time belongs to the frame [half the format's pairing tolerance].
constexpr Duration kSameFrame = std::chrono::milliseconds(10);

/// The scene's bodies, movable or not, at their initial poses, with the recording's tags.
Expected<std::vector<MovableBody>> bodies_of(const Recording& recording, const SceneManifest& scene,
                                             bool is_movable) {
  std::vector<MovableBody> bodies;
  for (const SceneObjectEntry& object : scene.objects) {
    if (object.is_movable != is_movable) continue;
    Expected<CadModel> model = read_object_model(scene, object);
    if (!model) return model.error();
    ObjectEntry entry{.name = object.name,
                      .mesh = object.mesh,
                      .mass = object.mass,
                      .is_movable = is_movable,
                      .T_base_object = object.T_base_object_start};
    bodies.push_back(
        {std::move(entry), std::move(*model), object_placements(recording.manifest, object.name)});
  }
  return bodies;
}

Error no_object(const SceneManifest& scene, const char* what) {
  return {.message = std::string("the scene has no ") + what,
          .file = (scene.folder / "scene.yaml").string(),
          .hint = "declare objects with mesh and pose or tags in recording.yaml, and build again"};
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

std::vector<ReplayedObject> replayed_objects(const std::vector<MovableBody>& bodies) {
  std::vector<ReplayedObject> objects;
  for (const MovableBody& body : bodies) {
    ReplayedObject& object = objects.emplace_back();
    object.name = body.entry.name;
    object.simplification = body.model.simplification;
  }
  return objects;
}

/// After the tracked ones: they keep their poses.
void add_immovable(const std::vector<MovableBody>& bodies, Replay& replay) {
  for (ReplayedObject& object : replayed_objects(bodies)) {
    object.is_movable = false;
    replay.objects.push_back(std::move(object));
  }
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

/// Keeps the displayed poses around the frames' stamps, and the first and the last: enough to draw
/// the augmented frames.
class ShownAroundFrames {
 public:
  ShownAroundFrames(const std::vector<FrameFiles>& frames, std::vector<ShownPose>& kept)
      : frames_(&frames), kept_(&kept) {}

  void add(const ShownPose& shown) {
    const Stamp stamp = Stamp::from_seconds(shown.t);
    while (next_ < frames_->size() && newest_ &&
           (*frames_)[next_].color_stamp < Stamp::from_seconds(newest_->t)) {
      ++next_;
    }
    const bool is_near = next_ < frames_->size() && (*frames_)[next_].color_stamp <= stamp;
    if (is_near) keep_newest();
    newest_ = shown;
    is_kept_ = false;
    if (is_near || kept_->empty()) keep_newest();
  }
  void keep_newest() {
    if (newest_ && !is_kept_) kept_->push_back(*newest_);
    is_kept_ = true;
  }

 private:
  const std::vector<FrameFiles>* frames_;
  std::vector<ShownPose>* kept_;
  std::size_t next_ = 0;
  std::optional<ShownPose> newest_;
  bool is_kept_ = false;
};

/// Shifts times from the recording's start to its clock.
void shift_to_clock(Stamp start, TeleopRun& run) {
  const double seconds = start.seconds();
  for (std::vector<ShownPose>& shown : run.shown) {
    for (ShownPose& pose : shown) pose.t += seconds;
  }
  for (ForceRow& row : run.forces) row.t += seconds;
  for (PhaseRow& row : run.phases) row.t += seconds;
  for (SentCorrection& sent : run.corrections) sent.t += seconds;
}

/// Runs both sites; their output is streamed to the replay's folder where it has one.
Expected<TeleopRun> run_sites(const Recording& recording, const TeleopInput& input,
                              const ReplayOptions& options, const Replay& replay,
                              const Observer& observer) {
  const Stamp start = start_of(recording);
  if (!options.run_folder) {
    Expected<TeleopRun> run = run_teleop(input, options.teleop, observer);
    if (run) shift_to_clock(start, *run);
    return run;
  }
  TeleopWriter writer;
  const Expected<void> opened = writer.open(*options.run_folder, object_names(replay));
  if (!opened) return opened.error();
  std::vector<std::vector<ShownPose>> kept(input.objects.size());
  std::vector<ShownAroundFrames> around;
  around.reserve(kept.size());
  for (std::vector<ShownPose>& shown : kept) around.emplace_back(recording.frames, shown);
  const auto on_clock = [seconds = start.seconds()](auto row) {
    row.t += seconds;
    return row;
  };
  TeleopSink sink = writer.sink();
  sink.take_shown = [&](std::size_t object, const ShownPose& shown) {
    around[object].add(on_clock(shown));
    return writer.add_shown(object, on_clock(shown));
  };
  sink.take_force = [&](const ForceRow& row) { return writer.add_force(on_clock(row)); };
  sink.take_correction = [&](const SentCorrection& sent) {
    return writer.add_correction(on_clock(sent));
  };
  Expected<TeleopRun> run = run_teleop(input, options.teleop, sink, observer);
  if (!run) return run;
  const Expected<void> closed = writer.close();
  if (!closed) return closed.error();
  for (ShownAroundFrames& shown : around) shown.keep_newest();
  shift_to_clock(start, *run);  // the phases only: the sink has all other rows
  run->shown = std::move(kept);
  return run;
}

/// Reads earlier tracking of the scene's bodies.
Expected<Replay> read_tracking(const std::filesystem::path& folder,
                               const std::vector<MovableBody>& bodies) {
  Replay replay;
  replay.tracked_folder = folder;
  bool has_any = false;
  replay.objects = replayed_objects(bodies);
  for (ReplayedObject& object : replay.objects) {
    Expected<std::vector<TrackedPose>> tracked = read_tracked_poses(folder, object.name);
    if (!tracked) return tracked.error();
    has_any = has_any || !tracked->empty();
    object.tracked = std::move(*tracked);
  }
  if (!has_any && !bodies.empty()) {
    return Error{.message = "no objects/NAME/tracked.txt of the scene's objects",
                 .file = folder.string(),
                 .hint = "give a run, or the folder tracked of a simulated recording"};
  }
  return replay;
}

/// Tracks the bodies through the recording's images.
Expected<Replay> track_by_images(const Recording& recording, const SceneManifest& scene,
                                 const std::vector<MovableBody>& bodies,
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
  clock.end();
  replay.frames_recorded = recording.frames.size() + recording.unpaired_color;
  replay.frames_dropped = dropped_frames(recording, *survey);
  replay.camera_trajectory = placed_frames(survey->camera);
  replay.times = clock.times();
  return replay;
}

Expected<Replay> track(const Recording& recording, const SceneManifest& scene,
                       const std::vector<MovableBody>& bodies, const ReplayOptions& options,
                       const Observer& observer) {
  if (const auto folder = tracked_folder_of(recording, options.tracked)) {
    Expected<Replay> replay = read_tracking(*folder, bodies);
    if (!replay || recording.frames.empty()) return replay;
    const Expected<Trajectory> camera = read_camera_trajectory(scene);
    if (!camera) return camera.error();
    const auto known = camera_of_scene(recording, *camera, scene.quality);
    if (known) replay->camera_trajectory = placed_frames(*known);
    return replay;
  }
  if (bodies.empty()) return Replay();
  const bool has_images = recording.manifest.camera && !recording.frames.empty();
  if (has_images || recording.tool.empty()) {
    return track_by_images(recording, scene, bodies, options, observer);
  }
  observer.on_warning("the recording has no images: objects are predicted without tracking");
  Replay replay;
  replay.objects = replayed_objects(bodies);
  return replay;
}

/// Tracking in seconds from the recording's start. A double resolves seconds since 1970 to 0.2 us:
/// rounding to microseconds, the resolution of written stamps, restores the exact values.
std::vector<TrackedPose> tracked_from_start(std::vector<TrackedPose> tracked, Stamp start) {
  constexpr double kMicroseconds = 1e6;  // per second
  for (TrackedPose& pose : tracked) {
    pose.t = std::round((pose.t - start.seconds()) * kMicroseconds) / kMicroseconds;
  }
  return tracked;
}

/// Objects and static surface of a scene, without any series.
Expected<TeleopInput> world_of(const SceneManifest& scene, const std::vector<MovableBody>& bodies,
                               const ParameterTable& known) {
  TeleopInput input;
  for (const MovableBody& body : bodies) {
    input.objects.push_back({body.entry.name,
                             body.model,
                             *body.entry.T_base_object,
                             known.at(body.entry.name),
                             {},
                             body.entry.is_movable});
  }
  if (!scene.is_scanned()) return input;
  Expected<TriangleMesh> mesh = read_mesh(scene.folder / "mesh.ply");
  if (!mesh) return mesh.error();
  input.static_mesh_base = std::move(*mesh);
  for (const MovableBody& body : bodies) {
    if (body.entry.is_movable) continue;
    remove_surface_of(transformed(*body.entry.T_base_object, body.model.mesh_object),
                      input.static_mesh_base);
  }
  return input;
}

void add_tool(const Recording& recording, TeleopInput& input) {
  const Stamp start = start_of(recording);
  input.tool_radius = recording.manifest.tool_radius.value_or(input.tool_radius);
  input.t_tool.reserve(recording.tool.size());
  input.p_base_tip.reserve(recording.tool.size());
  input.q_base_tool.reserve(recording.tool.size());
  for (const TimedPose& tool : recording.tool.poses()) {
    input.t_tool.push_back(to_seconds(tool.stamp - start));
    input.p_base_tip.push_back(tool.pose.translation());
    input.q_base_tool.push_back(tool.pose.rotation());
  }
}

void add_wrench(const Recording& recording, TeleopInput& input) {
  const Stamp start = start_of(recording);
  input.t_force.reserve(recording.wrench.size());
  input.force_base.reserve(recording.wrench.size());
  for (const WrenchSample& sample : recording.wrench) {
    input.t_force.push_back(to_seconds(sample.stamp - start));
    input.force_base.push_back(sample.force);
  }
}

Expected<TeleopInput> teleop_input(const Recording& recording, const SceneManifest& scene,
                                   const std::vector<MovableBody>& bodies, const Replay& replay,
                                   const ParameterTable& known) {
  Expected<TeleopInput> input = world_of(scene, bodies, known);
  if (!input) return input;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    input->objects[i].tracked = tracked_from_start(replay.objects[i].tracked, start_of(recording));
  }
  add_tool(recording, *input);
  add_wrench(recording, *input);
  return input;
}

/// The scene's objects, the movable ones first, and their parameters.
struct KnownBodies {
  std::vector<MovableBody> movable;
  std::vector<MovableBody> immovable;
  ParameterTable parameters;
};

Expected<KnownBodies> known_bodies(const Recording& recording, const SceneManifest& scene,
                                   const ReplayOptions& options, const Observer& observer) {
  Expected<std::vector<MovableBody>> bodies = bodies_of(recording, scene, true);
  if (!bodies) return bodies.error();
  for (const MovableBody& body : *bodies) report_simplified(body.model, observer);
  Expected<ParameterTable> known =
      known_parameters(scene, options.parameters, options.parameters_file);
  if (!known) return known.error();
  Expected<std::vector<MovableBody>> immovable = bodies_of(recording, scene, false);
  if (!immovable) return immovable.error();
  for (const MovableBody& body : *immovable) report_simplified(body.model, observer);
  if (bodies->empty() && immovable->empty()) return no_object(scene, "object");
  return KnownBodies{std::move(*bodies), std::move(*immovable), std::move(*known)};
}

std::vector<MovableBody> all_of(KnownBodies&& bodies) {
  std::vector<MovableBody> all = std::move(bodies.movable);
  std::move(bodies.immovable.begin(), bodies.immovable.end(), std::back_inserter(all));
  return all;
}

}  // namespace

Expected<Replay> replay_recording(const Recording& recording, const SceneManifest& scene,
                                  const ReplayOptions& options, const Observer& observer) {
  const ImageUse images = options.tracked ? ImageUse::none : ImageUse::tracking;
  if (const auto conflict = check_clocks(recording, images, observer)) return *conflict;
  if (recording.tool.empty()) observer.on_warning(kNothingPredicted);
  Expected<KnownBodies> bodies = known_bodies(recording, scene, options, observer);
  if (!bodies) return bodies.error();
  Expected<Replay> replay = track(recording, scene, bodies->movable, options, observer);
  if (replay) add_immovable(bodies->immovable, *replay);
  if (replay) replay->configuration = options.configuration;
  if (!replay || recording.tool.empty()) return replay;
  StageClock clock;
  clock.begin("both sites");
  const ParameterTable known = bodies->parameters;
  Expected<TeleopInput> input =
      teleop_input(recording, scene, all_of(std::move(*bodies)), *replay, known);
  if (!input) return input.error();
  replay->run_folder = options.run_folder;
  Expected<TeleopRun> run = run_sites(recording, *input, options, *replay, observer);
  if (!run) {
    Error error = run.error();
    const std::filesystem::path named = recording.folder / error.file;
    if (!error.file.empty() && std::filesystem::exists(named)) error.file = named.string();
    return error;
  }
  clock.end();
  replay->teleop = std::move(*run);
  replay->parameters_file = options.parameters ? options.parameters_file : "none";
  replay->teleop_options = options.teleop;
  const std::vector<StageTime> times = clock.times();
  replay->times.insert(replay->times.end(), times.begin(), times.end());
  return replay;
}

Expected<TeleopInput> read_teleop_input(const Recording& recording, const SceneManifest& scene,
                                        const ReplayOptions& options, const Observer& observer) {
  Expected<KnownBodies> bodies = known_bodies(recording, scene, options, observer);
  if (!bodies) return bodies.error();
  const Expected<Replay> replay = track(recording, scene, bodies->movable, options, observer);
  if (!replay) return replay.error();
  Replay all = *replay;
  add_immovable(bodies->immovable, all);
  const ParameterTable known = bodies->parameters;
  return teleop_input(recording, scene, all_of(std::move(*bodies)), all, known);
}

Expected<TeleopInput> read_teleop_world(const SceneManifest& scene, const ReplayOptions& options,
                                        const Observer& observer) {
  Expected<KnownBodies> bodies = known_bodies(Recording(), scene, options, observer);
  if (!bodies) return bodies.error();
  const ParameterTable known = bodies->parameters;
  return world_of(scene, all_of(std::move(*bodies)), known);
}

void add_tool_motion(const Recording& recording, TeleopInput& input) { add_tool(recording, input); }

Expected<Replay> replay_tracking(const Recording& recording, const SceneManifest& scene,
                                 const ReplayOptions& options, const Observer& observer) {
  const Expected<std::vector<MovableBody>> bodies = bodies_of(recording, scene, true);
  if (!bodies) return bodies.error();
  if (bodies->empty()) return no_object(scene, "movable object to track");
  return track_by_images(recording, scene, *bodies, options, observer);
}

}  // namespace pcavr
