// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/devices/jitter_buffer.hpp"

#include <algorithm>
#include <cmath>

namespace pcavr {
namespace {

/// [s] Initial estimate: a page that renders at 60 Hz sends once per frame.
constexpr double kDefaultInterval = 1.0 / 60.0;
/// Number of outliers ignored among the last 32 arrivals: a single stutter of the page causes one
/// stop, but does not increase the delay.
constexpr std::size_t kMaxOutliers = 1;
/// [s] A sample waits for up to a cycle after its arrival.
constexpr double kMaxWait = 0.001;
/// [s] A network's latency does not change by this much between two samples, so the clock has
/// jumped.
constexpr double kClockJump = 1.0;

double offset(const RemoteSample& sample) { return sample.arrival - sample.sender_clock; }

}  // namespace

bool JitterBuffer::add(const RemoteSample& sample) noexcept {
  const bool restarts = count_ == 0 || sample.sender_clock <= newest().sender_clock ||
                        std::abs(offset(sample) - offset(newest())) > kClockJump;
  if (restarts) clear();
  samples_[count_ % kSize] = sample;
  ++count_;
  update_delay();
  if (restarts) shown_ = sample.sender_clock;
  return restarts;
}

void JitterBuffer::update_delay() noexcept {
  // A segment's end must have arrived when its start is played out, for playout without stops.
  std::array<double, kSize> waits;
  std::size_t n = 0;
  fastest_ = offset(newest());
  for (std::size_t i = oldest(); i < count_; ++i) {
    fastest_ = std::min(fastest_, offset(sample(i)));
    if (i > oldest()) waits[n++] = sample(i).arrival - sample(i - 1).sender_clock;
  }
  target_lag_ = fastest_ + kDefaultInterval;
  if (n > 0) {
    const std::size_t allowed = n + 1 == kSize ? kMaxOutliers : 0;
    const auto quantile = waits.begin() + static_cast<std::ptrdiff_t>(n - 1 - allowed);
    std::nth_element(waits.begin(), quantile, waits.begin() + static_cast<std::ptrdiff_t>(n));
    target_lag_ = std::min(*quantile + kMaxWait, fastest_ + max_delay_);
  }
}

void JitterBuffer::advance(double t, double dt) noexcept {
  if (is_empty()) return;
  const double behind = t - target_lag_ - shown_;
  // Never backwards, and not beyond the target if that is ahead.
  const double step = std::max(0.0, dt * (1.0 + behind / catch_up_time_));
  shown_ = std::min(shown_ + std::min(step, std::max(behind, dt)), newest().sender_clock);
}

JitterBuffer::Tip JitterBuffer::at(double clock) const noexcept {
  std::size_t later = count_ - 1;
  while (later > oldest() && sample(later - 1).sender_clock >= clock) --later;
  const RemoteSample& end = sample(later);
  if (later == oldest() || clock >= end.sender_clock) return {end.p_base_tip, end.q_base_tool};
  const RemoteSample& begin = sample(later - 1);
  const double ratio = (clock - begin.sender_clock) / (end.sender_clock - begin.sender_clock);
  return {begin.p_base_tip + ratio * (end.p_base_tip - begin.p_base_tip),
          begin.q_base_tool.slerp(ratio, end.q_base_tool)};
}

}  // namespace pcavr
