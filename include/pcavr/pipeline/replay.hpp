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

#include "pcavr/core/expected.hpp"
#include "pcavr/core/observer.hpp"
#include "pcavr/core/parallel.hpp"
#include "pcavr/core/stage_clock.hpp"
#include "pcavr/geometry/depth_noise.hpp"
#include "pcavr/geometry/trajectory.hpp"
#include "pcavr/identification/object_parameters.hpp"
#include "pcavr/recording/recording.hpp"
#include "pcavr/scene/scene_bundle.hpp"
#include "pcavr/teleop/run_teleop.hpp"
#include "pcavr/tracking/object_tracker.hpp"

namespace pcavr {

/// What a replay without `Replay::teleop` says of itself.
inline constexpr char kNothingPredicted[] =
    "the recording has no tool.csv: only tracking is replayed, nothing is predicted";

struct ReplayOptions {
  DepthNoise depth_noise = {};
  bool trust_poses = false;
  bool skip_bad = false;
  Parallelism parallelism = Parallelism::max();
  /// Holds objects/NAME/tracked.txt, such as an earlier run does: taken instead of tracking again.
  std::optional<std::filesystem::path> tracked = {};
  /// What was identified before; without it the robot's site starts from what the scene knows.
  std::optional<ParameterTable> parameters = {};
  std::string parameters_file = {};  ///< by which the run names it
  TeleopOptions teleop = {};
  /// A folder that exists, an OutputFolder's: what grows with the recording is written there as it
  /// comes, for write_run() to complete, and not kept in the Replay. Without it everything is kept:
  /// half a megabyte and more for each second of recording.
  std::optional<std::filesystem::path> run_folder = {};
};

struct ReplayedObject {
  std::string name;
  /// One for each frame whose camera was placed; empty where tracking was taken from a folder, or
  /// written to one.
  std::vector<ObjectObservation> observations;
  std::vector<TrackedPose> tracked = {};  ///< without the frames in which it was lost
  /// How many frames showed it, by what; empty where tracking was taken from a folder.
  std::map<ObjectEvidence, std::size_t> frames_by_evidence = {};
  /// Where the scene's mesh stands in for a finer one.
  std::optional<CadModel::Simplification> simplification = {};
};

struct Replay {
  std::vector<ReplayedObject> objects;
  std::optional<std::filesystem::path> tracked_folder = {};  ///< where tracking was taken from
  /// What both sites did; empty where the recording has no tool motion. With a run_folder it holds
  /// neither forces nor corrections, and of the poses shown those around the frames' stamps.
  std::optional<TeleopRun> teleop = {};
  std::optional<std::filesystem::path> run_folder = {};  ///< as ReplayOptions has it
  std::string parameters_file = {};
  TeleopOptions teleop_options = {};
  bool camera_from_scene = false;  ///< the scene's own trajectory served: same recording
  /// T_base_camera at the depth images' stamps. Where tracking was taken from a folder, the
  /// scene's, if it was built from this recording; else empty.
  Trajectory camera_trajectory = {};
  std::size_t frames_recorded = 0;
  std::size_t frames_used = 0;
  std::vector<std::pair<std::string, std::size_t>> frames_dropped;  ///< reason, count
  std::vector<StageTime> times;
};

/// Follows the scene's movable objects through a recording by tags and shape. The camera's pose
/// comes from the scene where it was built from this recording, else from the recording itself.
[[nodiscard]] Expected<Replay> replay_tracking(const Recording& recording,
                                               const SceneManifest& scene,
                                               const ReplayOptions& options,
                                               const Observer& observer = {});

/// Reads objects/NAME/tracked.txt of a run, with the deviations from tracking.csv beside it (1 mm
/// and 10 mrad where that file is absent). Empty where the folder has no such object. Their seconds
/// count from `zero`: from a recording's start they are exact, since 1970 to 0.2 us only.
[[nodiscard]] Expected<std::vector<TrackedPose>> read_tracked_poses(
    const std::filesystem::path& folder, const std::string& name, Stamp zero = {});

/// The frames in which the object was seen; their seconds count from `zero`.
[[nodiscard]] std::vector<TrackedPose> tracked_poses_of(
    std::span<const ObjectObservation> observations, Stamp zero);

/// The whole chain of a replay: tracking by images, from a folder or, where there is neither, none;
/// then both sites over a delayed link, the recorded tool as the operator's command and the
/// recording as the remote truth. Without a tool motion it ends with the tracking.
[[nodiscard]] Expected<Replay> replay_recording(const Recording& recording,
                                                const SceneManifest& scene,
                                                const ReplayOptions& options,
                                                const Observer& observer = {});

/// Writes run.yaml, objects/NAME/tracked.txt and objects/NAME/tracking.csv (what carried each
/// pose, and how well) into a folder that exists; where both sites ran, also
/// objects/NAME/predicted.txt, force.csv, phases.csv, corrections.csv and parameters.yaml. Where
/// some of it was written already, `folder` is the replay's run_folder.
[[nodiscard]] Expected<void> write_run(const Replay& replay, const Recording& recording,
                                       const SceneManifest& scene,
                                       const std::filesystem::path& folder);

}  // namespace pcavr
