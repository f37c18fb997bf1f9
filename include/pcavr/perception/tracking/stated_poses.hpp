// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/perception/tracking/camera_tracker.hpp"

namespace pcavr {

/// Whether the std of the poses in groundtruth.txt is stated, or is another one than the default.
/// A default holds for usual sources, whose poses are now and then far off, and are then corrected;
/// stated ones hold for all poses of the file: alignments that contradict them are not used.
[[nodiscard]] inline bool are_pose_stds_stated(const CameraTrackerOptions& options) {
  return options.states_pose_stds ||
         options.groundtruth_position_std != CameraTrackerOptions().groundtruth_position_std;
}

/// States the std of the poses of groundtruth.txt [m, rad], > 0.
inline void state_pose_std(double std, CameraTrackerOptions& options) {
  options.groundtruth_position_std = std;
  options.groundtruth_rotation_std = std;
  options.states_pose_stds = true;
}

}  // namespace pcavr
