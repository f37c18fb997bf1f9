// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "pcavr/base/core/random.hpp"
#include "pcavr/teleoperation/haptics/haptic_tool.hpp"

#include "haptics/scanned_bumps.hpp"

namespace pcavr::test {

inline constexpr double kCycle = 0.001;  // [s]

/// A path may return this much more than it took: the minimum force, which needs no energy budget,
/// over a millimetre.
inline constexpr double kRounding = 1e-7;  // [J]

/// A closed path of a hand from 1 cm above the bumps into them and back: at most 20 m/s^2.
class ClosedPath {
 public:
  static constexpr int kSteps = 400;

  explicit ClosedPath(Random& random)
      : start_(random.uniform(0.08, 0.22), random.uniform(0.08, 0.22), 0.0) {
    for (Eigen::Vector3d& wave : waves_) {
      wave = {random.uniform(-0.006, 0.006), random.uniform(-0.006, 0.006),
              random.uniform(-0.003, 0.003)};
    }
    depth_ = random.uniform(0.008, 0.016);
    start_.z() = ScannedBumps::smooth_height(start_.x(), start_.y()) + 0.01;
  }

  [[nodiscard]] Eigen::Vector3d operator()(int step) const {
    const double turn = 2.0 * M_PI * step / kSteps;
    Eigen::Vector3d p = start_ - Eigen::Vector3d(0.0, 0.0, 0.5 * depth_ * (1.0 - std::cos(turn)));
    for (int i = 0; i < 4; ++i) p += std::sin((i + 1) * turn) / (i + 1) * waves_[i];
    return p;
  }

 private:
  Eigen::Vector3d start_;
  Eigen::Vector3d waves_[4];
  double depth_ = 0.0;
};

struct Work {
  double min = 0.0;  ///< [J] that a closed path took, over all paths
  double sum = 0.0;  ///< [J]
  long touched = 0;
  long active = 0;  ///< paths that returned more energy than they took, rounding included
};

inline Work over_closed_paths(HapticTool& tool, int paths) {
  Random random(11);
  Work work;
  for (int path = 0; path < paths; ++path) {
    const ClosedPath hand(random);
    if (!tool.reset(hand(0))) continue;
    Eigen::Vector3d tip = hand(0);
    (void)tool.step(tip, kCycle);
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    double taken = 0.0;
    bool has_touched = false;
    for (int i = 1; i <= ClosedPath::kSteps; ++i) {
      const Eigen::Vector3d next = hand(i);
      taken -= force.dot(next - tip);  // zero-order hold
      tip = next;
      const HapticState state = tool.step(tip, kCycle);
      force = state.force;
      has_touched |= state.is_in_contact;
    }
    work.min = std::min(work.min, taken);
    work.sum += taken;
    work.active += taken < 0.0 ? 1 : 0;
    work.touched += has_touched ? 1 : 0;
  }
  return work;
}

}  // namespace pcavr::test
