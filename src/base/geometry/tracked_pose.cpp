// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/geometry/tracked_pose.hpp"

#include <algorithm>
#include <iterator>

#include "pcavr/base/core/check.hpp"

namespace pcavr {

Pose pose_at(std::span<const TrackedPose> tracked, double t) {
  PCAVR_REQUIRE(!tracked.empty());
  const auto after = std::lower_bound(tracked.begin(), tracked.end(), t,
                                      [](const TrackedPose& p, double at) { return p.t < at; });
  if (after == tracked.begin()) return tracked.front().T_base_object;
  if (after == tracked.end()) return tracked.back().T_base_object;
  const auto before = std::prev(after);
  return interpolate(before->T_base_object, after->T_base_object,
                     (t - before->t) / (after->t - before->t));
}

}  // namespace pcavr
