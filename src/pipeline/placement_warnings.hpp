// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pcavr/geometry/trajectory.hpp"
#include "pcavr/tracking/camera_tracker.hpp"

namespace pcavr {

/// What a user should know of the camera's poses: which frames are left out, and what places them;
/// which given poses the images contradict. One sentence each; empty where all is well. Frames by
/// their index, from 0.
[[nodiscard]] std::vector<std::string> placement_warnings(const CameraTrack& track,
                                                          const Trajectory& given,
                                                          const CameraTrackerOptions& options);

}  // namespace pcavr
