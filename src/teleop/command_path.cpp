// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/command_path.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <utility>

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
// Half widths over the smallest, for a tip that is held or moves evenly for that long.
constexpr double kSteadyWindows[] = {8.0, 16.0};
/// Root mean square over such a window of what it changes, in stds of the narrowest window's noise,
/// at which both count alike.
constexpr double kSteadyStds = 1.25;
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

/// Mean of the values within `reach` of each.
std::vector<double> moving_mean(const std::vector<double>& values, std::size_t reach) {
  std::vector<double> sums(values.size() + 1, 0.0);
  for (std::size_t k = 0; k < values.size(); ++k) sums[k + 1] = sums[k] + values[k];
  std::vector<double> means(values.size());
  for (std::size_t k = 0; k < values.size(); ++k) {
    const std::size_t begin = k > reach ? k - reach : 0;
    const std::size_t end = std::min(k + reach + 1, values.size());
    means[k] = (sums[end] - sums[begin]) / static_cast<double>(end - begin);
  }
  return means;
}

/// One axis of a path, smoothed at times of equal intervals.
class CommandAxis {
 public:
  CommandAxis(const TipPath& tip, int axis, std::span<const double> at, double half_width)
      : tip_(tip),
        axis_(axis),
        at_(at),
        half_width_(half_width),
        interval_(mean_interval(tip.t)),
        path_(at.size()) {
    for (std::size_t k = 0; k < at.size(); ++k) path_[k] = tip.at(at[k])[axis];
  }

  /// From the narrowest window to the widest, the result moves to the wider one's, unless they
  /// differ by more than the noise: after the intersection of confidence intervals [Goldenshluger &
  /// Nemirovski 1997], with weights instead of a choice, so that the path has no steps.
  void smooth_locally() {
    double last_std = 0.0;
    for (const double factor : kCommandWindows) {
      const double noise = noise_of(factor);
      const double max_gap =
          kWindowStds * std::sqrt(std::max(0.0, last_std * last_std - noise * noise));
      const std::vector<double> gaps = gaps_to(factor);
      for (std::size_t k = 0; k < path_.size(); ++k) {
        const double ratio = last_std > 0.0 ? std::abs(gaps[k]) / max_gap : 0.0;
        path_[k] += gaps[k] / (1.0 + std::pow(ratio, 4));
      }
      last_std = noise;
      if (!(noise > 0.0)) break;  // nothing to remove
    }
  }

  /// Where smooth_locally meets noise of several stds it keeps it, for it may be motion: the
  /// largest force of a long contact was that of the noise, by 7 to 40 % on a slot's walls. What
  /// the motion does shows all along a wide window, so that the windows are compared over it.
  void smooth_steady() {
    const double narrowest = noise_of(1.0);
    if (!(narrowest > 0.0)) return;
    for (const double factor : kSteadyWindows) {
      const std::vector<double> gaps = gaps_to(factor);
      std::vector<double> squares(gaps.size());
      for (std::size_t k = 0; k < gaps.size(); ++k) squares[k] = gaps[k] * gaps[k];
      const double reach = factor * half_width_ / (at_[1] - at_[0]);
      squares = moving_mean(squares, static_cast<std::size_t>(reach));
      for (std::size_t k = 0; k < path_.size(); ++k) {
        const double ratio = std::sqrt(squares[k]) / (kSteadyStds * narrowest);
        path_[k] += gaps[k] / (1.0 + std::pow(ratio, 8));
      }
    }
  }

  [[nodiscard]] std::vector<double> take() { return std::move(path_); }

 private:
  [[nodiscard]] double noise_of(double factor) const {
    return tip_.noise * std::sqrt(kKernelEnergy * interval_ / (factor * half_width_));
  }

  /// From the path to the window's result; 0 where the window is not complete.
  [[nodiscard]] std::vector<double> gaps_to(double factor) const {
    const double width = factor * half_width_;
    // The kernel flattens a peak by half its variance times the acceleration, 11 % at 10 Hz and
    // 20 ms; less that, it is of fourth order, which leaves 1.3 % and has 1.3 times the noise.
    const double flattening = 0.5 * kKernelVariance * width * width;
    const std::vector<SmoothedSample> smoothed = smooth_axis(tip_, axis_, at_, width);
    std::vector<double> gaps(path_.size(), 0.0);
    for (std::size_t k = 0; k < path_.size(); ++k) {
      if (!smoothed[k].is_valid) continue;
      gaps[k] = smoothed[k].value - flattening * smoothed[k].acceleration - path_[k];
    }
    return gaps;
  }

  const TipPath& tip_;
  int axis_;
  std::span<const double> at_;
  double half_width_;
  double interval_;
  std::vector<double> path_;
};

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
  // And that the widest windows are compared over.
  const double widest = half_width_ * kSteadyWindows[std::size(kSteadyWindows) - 1];
  const std::size_t margin = kReach + static_cast<std::size_t>(widest / (2.0 * step_));
  std::vector<double> at(kBlock / 2 + 1 + 2 * margin);
  const std::size_t half_blocks = block * (kBlock / 2);
  const double first = static_cast<double>(half_blocks) - static_cast<double>(margin);
  for (std::size_t k = 0; k < at.size(); ++k) {
    at[k] = start_ + 2.0 * step_ * (first + static_cast<double>(k));
  }
  const double span = 2.0 * step_ * kReach;
  for (int axis = 0; axis < 3; ++axis) {
    CommandAxis command(tip_, axis, at, half_width_);
    command.smooth_locally();
    command.smooth_steady();
    const std::vector<double> position = command.take();
    const auto value = [&](std::size_t k) { return position[k + margin]; };
    const auto bend = [&](std::size_t k) {
      return (position[k + margin + kReach] - 2.0 * position[k + margin] +
              position[k + margin - kReach]) /
             (span * span);
    };
    for (std::size_t k = 0; k < kBlock; ++k) {
      path_[k][axis] = k % 2 == 1 ? 0.5 * (value(k / 2) + value(k / 2 + 1)) : value(k / 2);
      acceleration_[k][axis] = k % 2 == 1 ? 0.5 * (bend(k / 2) + bend(k / 2 + 1)) : bend(k / 2);
    }
  }
}

}  // namespace pcavr
