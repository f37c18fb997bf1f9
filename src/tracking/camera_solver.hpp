// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pcavr/geometry/trajectory.hpp"
#include "pcavr/tracking/camera_tracker.hpp"

#include "camera_map.hpp"

namespace pcavr::tracking {

/// All that the front end and the tags found out about a recording.
struct SolverInput {
  const CameraModel* color_camera = nullptr;  ///< which the tags' corners were found with
  const std::vector<Keyframe>* keyframes = nullptr;
  const std::vector<FrameRecord>* records = nullptr;
  const std::vector<TagPlacement>* base_tags = nullptr;
  const Trajectory* groundtruth = nullptr;
  CameraTrackerOptions options = {};
};

/// Places every frame in base: segments are anchored, all measurements are solved together, and
/// where the camera never moved one pose is fitted to all of them.
[[nodiscard]] CameraTrack solve_track(const SolverInput& input);

}  // namespace pcavr::tracking
