// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/slow_slide.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "pcavr/base/core/median.hpp"

namespace pcavr {
namespace {

// [stds] Smallest displacement from quarter to quarter.
constexpr double kStds = 3.0;
// A stated std counts up to so many times the frames' scatter, of their second differences: what is
// constant in the tracker's error is no motion. The second is the number of frames from which on
// this holds, the third the least std [m].
constexpr double kMaxScatterRatio = 3.0;
constexpr std::size_t kMinScatterFrames = 8;
constexpr double kMinStd = 1e-5;
// Windows over the shortest one: slower slides need more time.
constexpr double kWindowFactors[] = {1.0, 2.0, 3.0};
constexpr double kMaxWindowFactor = 3.0;
// Displacement that is no more than noise, as a share of one that is significant.
constexpr double kRestShare = 0.5;
// Share of the body's displacement: a tip that pushes the body goes at least this far.
constexpr double kMinTipShare = 0.5;
// [s] Stamps of a window's borders, within rounding.
constexpr double kRounding = 1e-6;

}  // namespace

void SlowSlide::restart(std::optional<double> rest) {
  frames_.clear();
  rest_ = rest;
}

void SlowSlide::add(const Frame& frame) {
  frames_.push_back(frame);
  const double oldest = frame.t - kMaxWindowFactor * window_ - kRounding;
  while (frames_.front().t < oldest) frames_.pop_front();
  max_std_ = scatter_std();
}

double SlowSlide::scatter_std() const {
  if (frames_.size() < kMinScatterFrames) return std::numeric_limits<double>::infinity();
  std::vector<double> seconds;
  for (std::size_t i = 2; i < frames_.size(); ++i) {
    const double second = frames_[i].body - 2.0 * frames_[i - 1].body + frames_[i - 2].body;
    seconds.push_back(std::abs(second));
  }
  const double std = kStdOverMad * median(std::move(seconds)) / std::sqrt(6.0);
  return std::max(kMaxScatterRatio * std, kMinStd);
}

std::optional<SlowSlide::Mean> SlowSlide::mean_of(double from, double to) const {
  Mean mean;
  double count = 0.0;
  for (const Frame& frame : frames_) {
    if (frame.t < from || frame.t >= to) continue;
    mean.t += frame.t;
    mean.body += frame.body;
    mean.variance += std::pow(std::min(frame.body_std, max_std_), 2);
    mean.tip += frame.tip;
    count += 1.0;
  }
  if (count == 0.0) return std::nullopt;
  return Mean{mean.t / count, mean.body / count, mean.variance / (count * count), mean.tip / count};
}

std::optional<double> SlowSlide::onset_within(double window) const {
  const double end = frames_.back().t + kRounding;
  const double quarter = window / 4.0 + kRounding;
  const double begin = end - 4.0 * quarter;
  if (frames_.front().t > begin + 0.5 * quarter) return std::nullopt;
  std::array<Mean, 4> means;
  for (std::size_t k = 0; k < means.size(); ++k) {
    const double from = begin + static_cast<double>(k) * quarter;
    const std::optional<Mean> mean = mean_of(from, from + quarter);
    if (!mean) return std::nullopt;
    means[k] = *mean;
    if (k == 0) continue;
    // A step is ahead in two of the three at most.
    const double noise = std::sqrt(means[k].variance + means[k - 1].variance);
    if (means[k].body - means[k - 1].body < kStds * noise) return std::nullopt;
  }
  const double moved = means[3].body - means[0].body;
  if (moved < min_displacement_) return std::nullopt;
  if (means[3].tip - means[0].tip < kMinTipShare * moved) return std::nullopt;
  const double speed = moved / (means[3].t - means[0].t);
  const double slid = means[3].body - rest_.value_or(means[0].body);
  return std::clamp(means[3].t - slid / speed, frames_.front().t, means[3].t);
}

std::optional<double> SlowSlide::onset() const {
  for (const double factor : kWindowFactors) {
    if (frames_.empty()) break;
    if (const auto found = onset_within(factor * window_)) return found;
  }
  return std::nullopt;
}

bool SlowSlide::is_at_rest() const {
  if (frames_.empty()) return false;
  const double end = frames_.back().t + kRounding;
  const double half = 0.5 * window_;
  if (frames_.front().t > end - 2.0 * half) return false;
  const auto before = mean_of(end - 2.0 * half, end - half);
  const auto now = mean_of(end - half, end);
  if (!before || !now) return false;
  const double noise = kStds * std::sqrt(before->variance + now->variance);
  return now->body - before->body < kRestShare * noise;
}

}  // namespace pcavr
