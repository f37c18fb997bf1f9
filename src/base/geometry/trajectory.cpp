// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/geometry/trajectory.hpp"

#include <algorithm>
#include <utility>

#include "pcavr/base/core/check.hpp"

namespace pcavr {
namespace {

auto lower_bound_of(const std::vector<TimedPose>& poses, Stamp stamp) {
  return std::lower_bound(poses.begin(), poses.end(), stamp,
                          [](const TimedPose& pose, Stamp when) { return pose.stamp < when; });
}

}  // namespace

Trajectory::Trajectory(std::vector<TimedPose> poses) : poses_(std::move(poses)) {
  const auto out_of_order =
      std::adjacent_find(poses_.begin(), poses_.end(),
                         [](const TimedPose& a, const TimedPose& b) { return a.stamp >= b.stamp; });
  PCAVR_REQUIRE(out_of_order == poses_.end());
}

void Trajectory::append(Stamp stamp, const Pose& pose) {
  PCAVR_REQUIRE(poses_.empty() || poses_.back().stamp < stamp);
  poses_.push_back({stamp, pose});
}

std::optional<Pose> Trajectory::at(Stamp stamp, Duration max_gap) const {
  const auto after = lower_bound_of(poses_, stamp);
  if (after == poses_.end()) return std::nullopt;
  if (after->stamp == stamp) return after->pose;
  if (after == poses_.begin()) return std::nullopt;
  const auto before = after - 1;
  if (after->stamp - before->stamp > max_gap) return std::nullopt;
  const double fraction =
      to_seconds(stamp - before->stamp) / to_seconds(after->stamp - before->stamp);
  return interpolate(before->pose, after->pose, fraction);
}

std::optional<std::size_t> Trajectory::nearest(Stamp stamp, Duration tolerance) const {
  if (poses_.empty()) return std::nullopt;
  auto best = lower_bound_of(poses_, stamp);
  if (best == poses_.end() ||
      (best != poses_.begin() && stamp - (best - 1)->stamp <= best->stamp - stamp)) {
    --best;
  }
  const Duration difference = best->stamp > stamp ? best->stamp - stamp : stamp - best->stamp;
  if (difference > tolerance) return std::nullopt;
  return static_cast<std::size_t>(best - poses_.begin());
}

}  // namespace pcavr
