// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/command_path.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/physics/identification/signals.hpp"

#include "teleoperation/teleop/motion_smoother.hpp"

namespace pcavr {
namespace {

// Cycles of a command that are computed at once: some seconds.
constexpr std::size_t kBlock = 4096;

/// Samples [begin, end) of `t` from `from` to `to` [s], and one more on either side: two or more.
struct SampleRange {
  SampleRange(std::span<const double> t, double from, double to) {
    const auto first = std::lower_bound(t.begin(), t.end(), from);
    const auto last = std::upper_bound(first, t.end(), to);
    begin = static_cast<std::size_t>(first - t.begin());
    const auto end = std::min(static_cast<std::size_t>(last - t.begin()) + 1, t.size());
    begin = std::min(begin > 0 ? begin - 1 : 0, t.size() - 2);
    count = std::max(end, begin + 2) - begin;
  }
  std::size_t begin = 0;
  std::size_t count = 0;
};

/// The most likely motion between samples is a cubic. The tip is at rest before the first and after
/// the last.
double position_at(std::span<const double> t, std::span<const MotionSample> motion, double time) {
  if (time <= t.front()) return motion.front().position;
  if (time >= t.back()) return motion.back().position;
  const auto next =
      static_cast<std::size_t>(std::upper_bound(t.begin(), t.end(), time) - t.begin());
  const MotionSample& a = motion[next - 1];
  const MotionSample& b = motion[next];
  const double dt = t[next] - t[next - 1];
  const double u = (time - t[next - 1]) / dt;
  const double v = 1.0 - u;
  return v * v * ((1.0 + 2.0 * u) * a.position + u * dt * a.velocity) +
         u * u * ((1.0 + 2.0 * v) * b.position - v * dt * b.velocity);
}

}  // namespace

CommandPath::CommandPath(const TipPath& tip, double height_base, double start, double step)
    : tip_(tip),
      height_base_(height_base),
      unseen_(find_unrecorded_moves(tip)),
      start_(start),
      step_(step) {}

Eigen::Vector3d CommandPath::at(std::size_t cycle) {
  if (cycle / kBlock != block_) compute_block(cycle / kBlock);
  return path_[cycle % kBlock];
}

Eigen::Vector3d CommandPath::acceleration_at(std::size_t cycle) {
  if (cycle / kBlock != block_) compute_block(cycle / kBlock);
  return acceleration_[cycle % kBlock];
}

void CommandPath::compute_block(std::size_t block) {
  block_ = block;
  path_.resize(kBlock);
  acceleration_.resize(kBlock);
  const double first = start_ + step_ * static_cast<double>(block * kBlock);
  const double last = first + step_ * static_cast<double>(kBlock);
  const SampleRange near(tip_.t, first - kMotionReach, last + kMotionReach);
  const std::span<const double> t = tip_.t.subspan(near.begin, near.count);
  // The acceleration is a second difference over this time [s]: over less it has more noise.
  constexpr double kReach = 0.006;
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<MotionSample> motion =
        smooth_motion(t, axis_of(tip_.p_base.subspan(near.begin, near.count), axis), tip_.noise);
    for (std::size_t k = 0; k < kBlock; ++k) {
      const double time = first + step_ * static_cast<double>(k);
      const double here = position_at(t, motion, time);
      path_[k][axis] = here;
      acceleration_[k][axis] = (position_at(t, motion, time + kReach) - 2.0 * here +
                                position_at(t, motion, time - kReach)) /
                               (kReach * kReach);
    }
  }
  go_over_objects(first);
}

void CommandPath::go_over_objects(double first) {
  for (const UnrecordedMove& move : unseen_) {
    const double from = std::max((move.begin - first) / step_, 0.0);
    const double to = std::min((move.end - first) / step_, static_cast<double>(kBlock));
    for (double k = std::ceil(from); k < to; ++k) {
      const auto cycle = static_cast<std::size_t>(k);
      path_[cycle] = p_base_over_objects(move, height_base_, first + step_ * k);
      acceleration_[cycle].setZero();
    }
  }
}

}  // namespace pcavr
