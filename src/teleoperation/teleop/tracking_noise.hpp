// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <deque>

#include "pcavr/base/geometry/tracked_pose.hpp"

namespace pcavr {

/// The noise of an object's tracked poses from frame to frame. A tracker states its accuracy, and
/// often one that is too good (or that of one axis for that of all): then the switch corrects
/// noise. The noise follows from the difference of a pose from the line through its neighbours,
/// which is no motion while the object rests or goes steadily; errors that are the same in
/// neighbouring frames are not in it. Not thread-safe.
class TrackingNoise {
 public:
  /// The next pose of an object that does not start or stop; stamps ascend.
  void add(const TrackedPose& seen);
  /// `seen` with stds of at least the measured noise, once there are enough frames.
  [[nodiscard]] TrackedPose at_least(TrackedPose seen) const;

 private:
  /// Residual of a pose, as the std of a single pose: along each axis [m], and about the vertical
  /// [rad].
  struct Residual {
    std::array<double, 3> position;
    double heading;
  };
  std::deque<TrackedPose> newest_;  ///< up to three
  std::deque<Residual> residuals_;  ///< the newest
  double position_std_ = 0.0;       ///< over all axes [m]; 0: not known yet
  double rotation_std_ = 0.0;       ///< about the vertical [rad]
};

}  // namespace pcavr
