// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pcavr/base/geometry/trajectory.hpp"

namespace pcavr {

/// A pose of the estimate, and the reference's at the same instant.
struct MatchedPose {
  Stamp stamp;
  Pose reference;
  Pose estimate;
};

/// The estimates for which the reference has a pose, interpolated over gaps up to `max_gap`.
[[nodiscard]] std::vector<MatchedPose> match(const Trajectory& reference,
                                             const Trajectory& estimate, Duration max_gap);

/// The reference's pose at `stamp`, interpolated over any gap, or its first or last pose where the
/// stamp lies outside its time span. The reference is not empty.
[[nodiscard]] Pose pose_near(const Trajectory& reference, Stamp stamp);

}  // namespace pcavr
