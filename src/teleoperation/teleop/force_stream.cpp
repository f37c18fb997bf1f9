// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/force_stream.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/physics/identification/smoothed_values.hpp"

namespace pcavr {
namespace {

/// Half width of the smoothing of tip and force [s]: a tenth of a push's loading time, and ten
/// samples of a typical sensor.
constexpr double kSmoothing = 0.010;
/// The spike filter uses this many later samples.
constexpr std::size_t kSpikeWindow = 3;
/// Fewer samples can't be smoothed, and contain no push.
constexpr std::size_t kMinForceSamples = 10;
/// [s] until they have come.
constexpr double kTypicalForceInterval = 0.002;
/// [s] after its lag that a sample waits for samples around it.
constexpr double kUncoveredTimeout = 0.050;
/// Samples are discarded in blocks: the remaining ones must be moved.
constexpr std::size_t kMinForceBlock = 4096;

}  // namespace

void ForceStream::add(double t, const Eigen::Vector3d& force_base) {
  t_.push_back(t - offset_);
  raw_base_.push_back(force_base);
  raw_noise_.add(force_base);
  ceiling_.add(force_base);
  if (raw_base_.size() <= kSpikeWindow) return;
  clean_base_.push_back(despiked(raw_base_.size() - 1 - kSpikeWindow));
  clean_noise_.add(clean_base_.back());
}

Eigen::Vector3d ForceStream::despiked(std::size_t index) const {
  const std::size_t begin = index > kSpikeWindow ? index - kSpikeWindow : 0;
  const std::size_t end = std::min(index + kSpikeWindow + 1, raw_base_.size());
  const auto part = std::span(raw_base_).subspan(begin, end - begin);
  SpikeOptions options;
  options.half_window = static_cast<int>(kSpikeWindow);
  Eigen::Vector3d clean;
  for (int axis = 0; axis < 3; ++axis) {
    options.noise = raw_noise_.std()[axis];
    clean[axis] = remove_spikes(axis_of(part, axis), options).values[index - begin];
  }
  return clean;
}

void ForceStream::set_offset(double offset) {
  for (double& t : t_) t -= offset - offset_;
  offset_ = offset;
}

std::optional<ForceStream::Sample> ForceStream::next(double after, double now,
                                                     const TipStream& tip) {
  if (t_.size() < kMinForceSamples || tip.empty()) return std::nullopt;
  next_ = std::max(
      next_, static_cast<std::size_t>(std::upper_bound(t_.begin(), t_.end(), after) - t_.begin()));
  if (next_ >= clean_base_.size()) return std::nullopt;
  const double end = t_[next_] + half_width();
  const bool is_covered =
      t_[clean_base_.size() - 1] >= end && tip.known_until().value_or(end) >= end;
  const double wait =
      lag() + kUncoveredTimeout + static_cast<double>(kSpikeWindow) * tip.interval();
  if (!is_covered && now < t_[next_] + wait) return std::nullopt;
  return smoothed(next_++, tip);
}

ForceStream::Sample ForceStream::smoothed(std::size_t index, const TipStream& tip) const {
  const double t = t_[index];
  const std::span<const double> t_clean = std::span(t_).first(clean_base_.size());
  return {t, clean_base_[index],
          smooth_point_at(t_clean, clean_base_, t, half_width()).value_or(clean_base_[index]),
          smooth_point_at(tip.t(), tip.p_base(), t, half_width()).value_or(tip.at(t))};
}

ForceStream::Record ForceStream::between(double from, double to) const {
  const std::span<const double> t = std::span(t_).first(clean_base_.size());
  const auto begin = std::lower_bound(t.begin(), t.end(), from);
  const auto end = std::upper_bound(begin, t.end(), to);
  const auto first = static_cast<std::size_t>(begin - t.begin());
  const auto count = static_cast<std::size_t>(end - begin);
  return {t.subspan(first, count), std::span(clean_base_).subspan(first, count)};
}

void ForceStream::discard_before(double time) {
  const auto last = t_.begin() + static_cast<std::ptrdiff_t>(clean_base_.size());
  const auto old = std::min(std::lower_bound(t_.begin(), last, time) - t_.begin(),
                            static_cast<std::ptrdiff_t>(next_) - 1);
  if (old < static_cast<std::ptrdiff_t>(kMinForceBlock)) return;
  t_.erase(t_.begin(), t_.begin() + old);
  raw_base_.erase(raw_base_.begin(), raw_base_.begin() + old);
  clean_base_.erase(clean_base_.begin(), clean_base_.begin() + old);
  next_ -= static_cast<std::size_t>(old);
  ceiling_.restart(raw_base_);
}

double ForceStream::interval() const {
  return t_.size() < kMinForceSamples ? kTypicalForceInterval : mean_interval(t_);
}

double ForceStream::half_width() const { return std::max(kSmoothing, 3.0 * interval()); }

double ForceStream::correlated() const { return correlated_samples(half_width(), interval()); }

double ForceStream::smooth_noise() const {
  return std::sqrt(3.0) * noise() / std::sqrt(correlated());
}

double ForceStream::lag() const {
  return half_width() + static_cast<double>(kSpikeWindow) * interval();
}

}  // namespace pcavr
