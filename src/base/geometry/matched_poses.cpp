// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/geometry/matched_poses.hpp"

#include <algorithm>

#include "pcavr/base/core/check.hpp"

namespace pcavr {

std::vector<MatchedPose> match(const Trajectory& reference, const Trajectory& estimate,
                               Duration max_gap) {
  std::vector<MatchedPose> matched;
  for (const TimedPose& timed : estimate.poses()) {
    const std::optional<Pose> truth = reference.at(timed.stamp, max_gap);
    if (truth) matched.push_back({timed.stamp, *truth, timed.pose});
  }
  return matched;
}

Pose pose_near(const Trajectory& reference, Stamp stamp) {
  PCAVR_REQUIRE(!reference.empty());
  const std::vector<TimedPose>& poses = reference.poses();
  const Stamp inside = std::clamp(stamp, poses.front().stamp, poses.back().stamp);
  return *reference.at(inside, Duration::max());
}

}  // namespace pcavr
