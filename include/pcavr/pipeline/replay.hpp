// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/core/expected.hpp"
#include "pcavr/core/observer.hpp"
#include "pcavr/core/parallel.hpp"
#include "pcavr/core/stage_clock.hpp"
#include "pcavr/geometry/depth_noise.hpp"
#include "pcavr/recording/recording.hpp"
#include "pcavr/scene/scene_bundle.hpp"
#include "pcavr/tracking/object_tracker.hpp"

namespace pcavr {

struct ReplayOptions {
  DepthNoise depth_noise = {};
  bool trust_poses = false;
  bool skip_bad = false;
  Parallelism parallelism = Parallelism::max();
};

struct ReplayedObject {
  std::string name;
  std::vector<ObjectObservation> observations;  ///< one for each frame whose camera was placed
};

struct Replay {
  std::vector<ReplayedObject> objects;
  bool camera_from_scene = false;  ///< the scene's own trajectory served: same recording
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

/// Writes run.yaml, objects/NAME/tracked.txt and objects/NAME/tracking.csv (what carried each
/// pose, and how well) into a folder that exists.
[[nodiscard]] Expected<void> write_run(const Replay& replay, const Recording& recording,
                                       const SceneManifest& scene,
                                       const std::filesystem::path& folder);

}  // namespace pcavr
