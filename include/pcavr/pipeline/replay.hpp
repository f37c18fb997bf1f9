// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/base/core/parallel.hpp"
#include "pcavr/base/core/stage_clock.hpp"
#include "pcavr/base/geometry/trajectory.hpp"
#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/perception/tracking/object_tracker.hpp"
#include "pcavr/physics/object/object_parameters.hpp"
#include "pcavr/pipeline/perception_options.hpp"
#include "pcavr/recordings/recording/recording.hpp"
#include "pcavr/teleoperation/teleop/run_teleop.hpp"

namespace pcavr {

/// The note of a replay without `Replay::teleop`.
inline constexpr char kNothingPredicted[] =
    "the recording has no tool.csv: only tracking is replayed, nothing is predicted";

struct ReplayOptions {
  PerceptionOptions perception = {};
  bool trust_poses = false;
  bool skip_bad = false;
  Parallelism parallelism = Parallelism::max();
  /// A folder with objects/NAME/tracked.txt, such as an earlier run: used instead of the
  /// recording's own `tracked`, and of tracking in the images.
  std::optional<std::filesystem::path> tracked = {};
  /// Identified earlier; without it the robot's site starts from the scene's parameters.
  std::optional<ParameterTable> parameters = {};
  std::string parameters_file = {};  ///< its name in the run's manifest
  TeleopOptions teleop = {};
  /// An existing folder (an OutputFolder's): data that grow with the recording are streamed to it,
  /// for write_run() to complete, and not kept in the Replay. Without it everything is kept in
  /// memory: half a megabyte and more for each second of recording.
  std::optional<std::filesystem::path> run_folder = {};
  /// Options that differ from their defaults, for the run's manifest: "section.key", value.
  std::vector<std::pair<std::string, std::string>> configuration = {};
};

struct ReplayedObject {
  std::string name;
  bool is_movable = true;  ///< false: it is not tracked, and follows those that are
  /// One for each frame with a camera pose; empty where tracking was read from a folder, or
  /// streamed to one.
  std::vector<ObjectObservation> observations;
  std::vector<TrackedPose> tracked = {};  ///< without the frames in which tracking was lost
  /// Number of frames by kind of evidence; empty where tracking was read from a folder.
  std::map<ObjectEvidence, std::size_t> frames_by_evidence = {};
  /// Set where the scene's mesh is a simplification of a finer one.
  std::optional<CadModel::Simplification> simplification = {};
};

struct Replay {
  std::vector<ReplayedObject> objects;
  std::optional<std::filesystem::path> tracked_folder = {};  ///< where tracking was read from
  std::vector<SkippedRows> left_out = {};                    ///< of that folder's files
  bool objects_are_logged = false;                           ///< `tracked` is of a live site's log
  /// The run of both sites; empty where the recording has no tool motion. With a run_folder it
  /// holds neither forces nor corrections, and of the displayed poses those around the frames'
  /// stamps.
  std::optional<TeleopRun> teleop = {};
  std::optional<std::filesystem::path> run_folder = {};  ///< as in ReplayOptions
  std::string parameters_file = {};
  TeleopOptions teleop_options = {};
  bool camera_from_scene = false;  ///< the scene's own trajectory is used: same recording
  /// T_base_camera at the depth images' stamps. Where tracking was read from a folder: the
  /// scene's, if it was built from this recording; else empty.
  Trajectory camera_trajectory = {};
  std::size_t frames_recorded = 0;
  std::size_t frames_used = 0;
  std::vector<std::pair<std::string, std::size_t>> frames_dropped;  ///< reason, count
  std::vector<StageTime> times;
  std::vector<std::pair<std::string, std::string>> configuration = {};  ///< as in ReplayOptions
};

/// Tracks the scene's movable objects through a recording by tags and shape. The camera's pose
/// comes from the scene where it was built from this recording, else from the recording itself.
[[nodiscard]] Expected<Replay> replay_tracking(const Recording& recording,
                                               const SceneManifest& scene,
                                               const ReplayOptions& options,
                                               const Observer& observer = {});

/// The folder that the objects' poses are read from: `given`, else the recording's own `tracked`
/// (motion capture, another tracker). Empty where there is neither: the images are tracked.
[[nodiscard]] std::optional<std::filesystem::path> tracked_folder_of(
    const Recording& recording, const std::optional<std::filesystem::path>& given);

/// An object's poses from a folder.
struct TrackedFile {
  std::vector<TrackedPose> poses;
  std::vector<SkippedRows> left_out;     ///< with skip_bad; files with the folder
  std::optional<std::string> note = {};  ///< that poses were repeated, and are left out
};

struct TrackedFileOptions {
  /// Times are seconds from here: exact from a recording's start, but only to 0.2 us since 1970
  /// (double).
  Stamp zero = {};
  bool skip_bad = false;       ///< skip and count bad rows of tracked.txt instead of failing
  Pose T_tracked_object = {};  ///< of the mesh in the frame that the folder's poses are of
};

/// TrackedFileOptions::T_tracked_object: the recording's own `tracked` has the poses of the
/// tracker's frame, a run's folder those of the mesh.
[[nodiscard]] Pose tracked_to_object(const Recording& recording,
                                     const std::filesystem::path& folder, const std::string& name);

/// Reads objects/NAME/tracked.txt of a run, with the stds from tracking.csv next to
/// it (1 mm and 10 mrad where that file is absent). Poses that a tracker repeated are left out
/// (recording/held_samples.hpp). Empty where the folder has no such object.
[[nodiscard]] Expected<TrackedFile> read_tracked_poses(const std::filesystem::path& folder,
                                                       const std::string& name,
                                                       const TrackedFileOptions& options = {});

/// The frames in which the object was seen; times are seconds from `zero`.
[[nodiscard]] std::vector<TrackedPose> tracked_poses_of(
    std::span<const ObjectObservation> observations, Stamp zero);

/// The whole pipeline of a replay: tracking by images, from a folder or, where there is neither,
/// none; then both sites over a delayed link, with the recorded tool as the operator's command and
/// the recording as the remote ground truth. Without tool motion it ends with the tracking.
[[nodiscard]] Expected<Replay> replay_recording(const Recording& recording,
                                                const SceneManifest& scene,
                                                const ReplayOptions& options,
                                                const Observer& observer = {});
/// The same, and releases the recording's tool motion and wrench once both sites have their own
/// copy: they are a third of the memory that an hour takes.
[[nodiscard]] Expected<Replay> replay_and_release(Recording& recording, const SceneManifest& scene,
                                                  const ReplayOptions& options,
                                                  const Observer& observer = {});

/// Writes run.yaml, objects/NAME/tracked.txt and objects/NAME/tracking.csv (evidence and
/// stds of each pose) into a folder that exists; where both sites ran, also
/// objects/NAME/predicted.txt, force.csv, phases.csv, corrections.csv and parameters.yaml. Where
/// the replay streamed some of them already, `folder` must be its run_folder.
[[nodiscard]] Expected<void> write_run(const Replay& replay, const Recording& recording,
                                       const SceneManifest& scene,
                                       const std::filesystem::path& folder);

}  // namespace pcavr
