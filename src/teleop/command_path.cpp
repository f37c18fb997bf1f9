// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/command_path.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "pcavr/identification/path_view.hpp"
#include "pcavr/identification/signals.hpp"

namespace pcavr {
namespace {

// Half width [s]: hand and arm motion is below 10 Hz.
constexpr double kCommandSmoothing = 0.020;
// Half widths over the smallest: the wider ones where the motion permits.
constexpr double kCommandWindows[] = {1.0, 2.0, 4.0};
/// Variance of the smoothing kernel (15/16)(1 - u^2)^2, in squared half widths.
constexpr double kKernelVariance = 1.0 / 7.0;
/// Integral of the square of the fourth-order kernel that results from its correction.
constexpr double kKernelEnergy = 1.25;
/// Difference of two windows' results, in its stds by noise, at which both count alike. With 2 the
/// peaks of presses came out 0.7 % lower (four simulated recordings, true contact law).
constexpr double kWindowStds = 1.0;
// Cycles of a command that are computed at once: some seconds.
constexpr std::size_t kBlock = 4096;

struct IndexRange {
  std::size_t begin = 0;
  std::size_t count = 0;
};

/// The samples that smoothing at times `from` to `to` uses, and one more on either side, which
/// shows that its window is complete.
IndexRange range_around(std::span<const double> t, double from, double to, double half_width) {
  const auto first = std::lower_bound(t.begin(), t.end(), from - half_width);
  const auto last = std::upper_bound(first, t.end(), to + half_width);
  const auto begin = static_cast<std::size_t>(first - t.begin());
  const auto end = static_cast<std::size_t>(last - t.begin());
  IndexRange range;
  range.begin = begin > 0 ? begin - 1 : 0;
  range.count = std::min(end + 1, t.size()) - range.begin;
  return range;
}

/// One axis of a path, smoothed at the given times in ascending order.
std::vector<SmoothedSample> smooth_axis(const TipPath& tip, int axis, std::span<const double> at,
                                        double half_width) {
  const IndexRange near = range_around(tip.t, at.front(), at.back(), half_width);
  return smooth(tip.t.subspan(near.begin, near.count),
                axis_of(tip.p_base.subspan(near.begin, near.count), axis), at, half_width);
}

/// One axis of the command at the given times. From the narrowest window to the widest, the result
/// moves to the wider one's, unless they differ by more than the noise: after the intersection of
/// confidence intervals [Goldenshluger & Nemirovski 1997], with weights instead of a choice, so
/// that the path has no steps.
std::vector<double> smooth_command(const TipPath& tip, int axis, std::span<const double> at,
                                   double half_width) {
  std::vector<double> path(at.size());
  for (std::size_t k = 0; k < at.size(); ++k) path[k] = tip.at(at[k])[axis];
  const double interval = mean_interval(tip.t);
  double last_std = 0.0;
  for (const double factor : kCommandWindows) {
    const double width = factor * half_width;
    // The kernel flattens a peak by half its variance times the acceleration, 11 % at 10 Hz and
    // 20 ms; less that, it is of fourth order, which leaves 1.3 % and has 1.3 times the noise.
    const double flattening = 0.5 * kKernelVariance * width * width;
    const double noise = tip.noise * std::sqrt(kKernelEnergy * interval / width);
    const double max_gap =
        kWindowStds * std::sqrt(std::max(0.0, last_std * last_std - noise * noise));
    const std::vector<SmoothedSample> smoothed = smooth_axis(tip, axis, at, width);
    for (std::size_t k = 0; k < at.size(); ++k) {
      if (!smoothed[k].is_valid) continue;
      const double value = smoothed[k].value - flattening * smoothed[k].acceleration;
      const double gap = std::abs(value - path[k]);
      const double weight = last_std > 0.0 ? 1.0 / (1.0 + std::pow(gap / max_gap, 4)) : 1.0;
      path[k] += weight * (value - path[k]);
    }
    last_std = noise;
    if (!(noise > 0.0)) break;  // nothing to remove
  }
  return path;
}

}  // namespace

CommandPath::CommandPath(const TipPath& tip, double start, double step)
    : tip_(tip),
      start_(start),
      step_(step),
      half_width_(std::max(kCommandSmoothing, 3.0 * mean_interval(tip.t))) {}

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
  // At every other time, with linear interpolation: its error is below a micrometre for a hand.
  // Beyond both ends for the acceleration, a second difference over this many times.
  constexpr std::size_t kReach = 3;
  std::vector<double> at(kBlock / 2 + 1 + 2 * kReach);
  const double first = static_cast<double>(block * (kBlock / 2)) - kReach;
  for (std::size_t k = 0; k < at.size(); ++k) {
    at[k] = start_ + 2.0 * step_ * (first + static_cast<double>(k));
  }
  const double span = 2.0 * step_ * kReach;
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<double> position = smooth_command(tip_, axis, at, half_width_);
    const auto value = [&](std::size_t k) { return position[k + kReach]; };
    const auto bend = [&](std::size_t k) {
      return (position[k + 2 * kReach] - 2.0 * position[k + kReach] + position[k]) / (span * span);
    };
    for (std::size_t k = 0; k < kBlock; ++k) {
      path_[k][axis] = k % 2 == 1 ? 0.5 * (value(k / 2) + value(k / 2 + 1)) : value(k / 2);
      acceleration_[k][axis] = k % 2 == 1 ? 0.5 * (bend(k / 2) + bend(k / 2 + 1)) : bend(k / 2);
    }
  }
}

}  // namespace pcavr
