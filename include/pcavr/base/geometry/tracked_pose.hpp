// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "pcavr/base/geometry/pose.hpp"

namespace pcavr {

/// An object's pose by marker tracking in one frame.
struct TrackedPose {
  double t = 0.0;  ///< [s]
  Pose T_base_object;
  double position_std = 0.0;  ///< [m]
  double rotation_std = 0.0;  ///< [rad]
};

/// T_base_object at `t` [s]: interpolated between frames, constant before the first and after the
/// last. `tracked` is not empty.
[[nodiscard]] Pose pose_at(std::span<const TrackedPose> tracked, double t);

}  // namespace pcavr
