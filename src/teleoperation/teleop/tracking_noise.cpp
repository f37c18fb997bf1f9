// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/tracking_noise.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "pcavr/base/core/median.hpp"
#include "pcavr/physics/prediction/body_physics.hpp"

namespace pcavr {
namespace {

// Frames that are enough, and the newest that count: two seconds of an ordinary camera.
constexpr std::size_t kMinFrames = 16;
constexpr std::size_t kMaxFrames = 60;

}  // namespace

void TrackingNoise::add(const TrackedPose& seen) {
  newest_.push_back(seen);
  if (newest_.size() < 3) return;
  if (newest_.size() > 3) newest_.pop_front();
  const TrackedPose &before = newest_[0], &middle = newest_[1], &after = newest_[2];
  const double share = (middle.t - before.t) / (after.t - before.t);
  // The residual of independent errors of equal std has this factor times that std.
  const double gain = std::sqrt(1.0 + share * share + (1.0 - share) * (1.0 - share));
  const Eigen::Vector3d first = before.T_base_object.translation();
  const Eigen::Vector3d residual = (middle.T_base_object.translation() - first -
                                    share * (after.T_base_object.translation() - first)) /
                                   gain;
  const auto turned_to = [&](const TrackedPose& pose) {
    return std::remainder(heading_of(pose.T_base_object) - heading_of(before.T_base_object),
                          2.0 * M_PI);
  };
  const double turned = (turned_to(middle) - share * turned_to(after)) / gain;
  residuals_.push_back(
      {{std::abs(residual.x()), std::abs(residual.y()), std::abs(residual.z())}, std::abs(turned)});
  if (residuals_.size() > kMaxFrames) residuals_.pop_front();
  if (residuals_.size() < kMinFrames) return;
  std::vector<double> positions, headings;
  for (const Residual& one : residuals_) {
    positions.insert(positions.end(), one.position.begin(), one.position.end());
    headings.push_back(one.heading);
  }
  position_std_ = std::sqrt(3.0) * kStdOverMad * median(std::move(positions));
  rotation_std_ = kStdOverMad * median(std::move(headings));
}

TrackedPose TrackingNoise::at_least(TrackedPose seen) const {
  seen.position_std = std::max(seen.position_std, position_std_);
  seen.rotation_std = std::max(seen.rotation_std, rotation_std_);
  return seen;
}

}  // namespace pcavr
