// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "devices/tip_playback.hpp"

#include <algorithm>
#include <cmath>

namespace pcavr {
namespace {

/// [s] A page that draws at 60 Hz sends once a picture: what is expected before it is known.
constexpr double kUsualInterval = 1.0 / 60.0;
/// [s] 30 Hz and half an interval of jitter. A hand that is shown later than that can't steer.
constexpr double kMaxDelay = 0.05;
/// Of the last 32 arrivals so many may be late: a single stutter of the page is waited for once,
/// but not worth half a second of delay.
constexpr std::size_t kLateAllowed = 1;
/// [s] After its arrival a sample lies for up to a cycle.
constexpr double kLies = 0.001;
/// [s] Within which a late sample is caught up: 10 ms late makes the tip a fifth faster.
constexpr double kCatchUp = 0.05;
/// [s] No way over a network changes by so much between two samples: the clock does.
constexpr double kClockJump = 1.0;

double offset(const RemoteSample& sample) { return sample.arrival - sample.sender_clock; }

}  // namespace

bool TipPlayback::add(const RemoteSample& sample) noexcept {
  const bool restarts = count_ == 0 || sample.sender_clock <= newest().sender_clock ||
                        std::abs(offset(sample) - offset(newest())) > kClockJump;
  if (restarts) clear();
  samples_[count_ % kKept] = sample;
  ++count_;
  judge_arrivals();
  if (restarts) shown_ = sample.sender_clock;
  return restarts;
}

void TipPlayback::judge_arrivals() noexcept {
  // To run along a line without a stop, its end must be here when its begin is shown.
  std::array<double, kKept> waits;
  std::size_t n = 0;
  fastest_ = offset(newest());
  for (std::size_t i = oldest(); i < count_; ++i) {
    fastest_ = std::min(fastest_, offset(sample(i)));
    if (i > oldest()) waits[n++] = sample(i).arrival - sample(i - 1).sender_clock;
  }
  kept_back_ = fastest_ + kUsualInterval;
  if (n > 0) {
    const std::size_t allowed = n + 1 == kKept ? kLateAllowed : 0;
    const auto enough = waits.begin() + static_cast<std::ptrdiff_t>(n - 1 - allowed);
    std::nth_element(waits.begin(), enough, waits.begin() + static_cast<std::ptrdiff_t>(n));
    kept_back_ = std::min(*enough + kLies, fastest_ + kMaxDelay);
  }
}

void TipPlayback::advance(double t, double dt) noexcept {
  if (is_empty()) return;
  const double behind = t - kept_back_ - shown_;
  // Never back, and never farther than to the moment aimed at when that lies ahead.
  const double step = std::max(0.0, dt * (1.0 + behind / kCatchUp));
  shown_ = std::min(shown_ + std::min(step, std::max(behind, dt)), newest().sender_clock);
}

TipPlayback::Place TipPlayback::at(double clock) const noexcept {
  std::size_t later = count_ - 1;
  while (later > oldest() && sample(later - 1).sender_clock >= clock) --later;
  const RemoteSample& end = sample(later);
  if (later == oldest() || clock >= end.sender_clock) return {end.p_base_tip, end.q_base_tool};
  const RemoteSample& begin = sample(later - 1);
  const double part = (clock - begin.sender_clock) / (end.sender_clock - begin.sender_clock);
  return {begin.p_base_tip + part * (end.p_base_tip - begin.p_base_tip),
          begin.q_base_tool.slerp(part, end.q_base_tool)};
}

}  // namespace pcavr
