// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pcavr/base/geometry/trajectory.hpp"
#include "pcavr/perception/tracking/camera_tracker.hpp"

#include "camera_map.hpp"

namespace pcavr::tracking {

/// Results of the front end and the tag detection for a recording.
struct SolverInput {
  const CameraModel* color_camera = nullptr;  ///< of the tag detections
  const std::vector<Keyframe>* keyframes = nullptr;
  const std::vector<FrameRecord>* records = nullptr;
  const std::vector<TagPlacement>* base_tags = nullptr;
  const Trajectory* groundtruth = nullptr;
  CameraTrackerOptions options = {};
};

/// SLAM back end: estimates every frame's pose in base. Anchors the segments and optimises the pose
/// graph of all measurements; for a fixed camera it fits one pose to all of them.
[[nodiscard]] CameraTrack solve_track(const SolverInput& input);

}  // namespace pcavr::tracking
