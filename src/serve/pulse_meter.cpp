// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pulse_meter.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/core/check.hpp"

namespace pcavr {
namespace {

// A page asks 60 to 90 times a second: a stroke that is shorter than two of its frames is missed.
constexpr double kStroke = 0.03;  // [s] at full strength
constexpr double kFading = 0.02;  // [s] by which it then falls to a third
// Half of the range is the hum's, so that a stroke is felt over it.
constexpr double kStrongestHum = 0.5;
// A tip that trembles on a noisy scan leaves it for some cycles: no touch is first within that.
constexpr double kAway = 0.05;  // [s]
constexpr double kLong = 1e3;   // [s] ago: before anything happened

}  // namespace

PulseMeter::PulseMeter(std::size_t bodies, double full_force)
    : full_force_(full_force), since_stroke_(kLong), since_touch_(kLong), was_held_(bodies, false) {
  PCAVR_REQUIRE(full_force > 0.0, full_force);
}

void PulseMeter::reset() noexcept {
  since_stroke_ = kLong;
  since_touch_ = kLong;
  amplitude_ = 0.0;
  std::fill(was_held_.begin(), was_held_.end(), false);
}

void PulseMeter::strike() noexcept {
  ++count_;
  since_stroke_ = 0.0;
}

void PulseMeter::step(const HapticWorldState& state, double dt) noexcept {
  since_stroke_ += dt;
  const bool touches = state.touches_scan || state.touched_body >= 0;
  if (touches && since_touch_ > kAway) strike();
  since_touch_ = touches ? 0.0 : since_touch_ + dt;
  for (std::size_t i = 0; i < was_held_.size(); ++i) {
    const MotionPhase phase = state.bodies[i].phase;
    if (phase == MotionPhase::sliding && was_held_[i]) strike();
    was_held_[i] = phase == MotionPhase::held || phase == MotionPhase::critical;
  }
  const double hum = kStrongestHum * std::min(1.0, state.force_base.norm() / full_force_);
  const double stroke = std::exp(-std::max(0.0, since_stroke_ - kStroke) / kFading);
  amplitude_ = std::clamp(std::max(hum, stroke), 0.0, 1.0);
}

}  // namespace pcavr
