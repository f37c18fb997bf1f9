// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pulse_generator.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/core/check.hpp"

namespace pcavr {
namespace {

// A page polls 60 to 90 times a second and would miss a pulse shorter than two of its frames.
constexpr double kPulseDuration = 0.03;  // [s] at full amplitude
constexpr double kDecayTime = 0.02;      // [s] time constant of the exponential decay after it
// The continuous vibration uses half of the range, so that a pulse stands out.
constexpr double kMaxVibration = 0.5;
// A tip that chatters on a noisy scan loses contact for some cycles: debounces the first contact.
constexpr double kMinTimeWithoutContact = 0.05;  // [s]
constexpr double kLongAgo = 1e3;                 // [s] no pulse or contact yet

}  // namespace

PulseGenerator::PulseGenerator(std::size_t bodies, double full_scale_force)
    : full_scale_force_(full_scale_force),
      since_pulse_(kLongAgo),
      since_contact_(kLongAgo),
      was_static_(bodies, false) {
  PCAVR_REQUIRE(full_scale_force > 0.0, full_scale_force);
}

void PulseGenerator::reset() noexcept {
  since_pulse_ = kLongAgo;
  since_contact_ = kLongAgo;
  amplitude_ = 0.0;
  std::fill(was_static_.begin(), was_static_.end(), false);
}

void PulseGenerator::start_pulse() noexcept {
  ++count_;
  since_pulse_ = 0.0;
}

void PulseGenerator::step(const HapticWorldState& state, double dt) noexcept {
  since_pulse_ += dt;
  const bool touches = state.touches_scan || state.touched_body >= 0;
  if (touches && since_contact_ > kMinTimeWithoutContact) start_pulse();
  since_contact_ = touches ? 0.0 : since_contact_ + dt;
  for (std::size_t i = 0; i < was_static_.size(); ++i) {
    const MotionPhase phase = state.bodies[i].phase;
    if (phase == MotionPhase::sliding && was_static_[i]) start_pulse();
    was_static_[i] = phase == MotionPhase::static_contact || phase == MotionPhase::critical;
  }
  const double vibration =
      kMaxVibration * std::min(1.0, state.force_base.norm() / full_scale_force_);
  const double pulse = std::exp(-std::max(0.0, since_pulse_ - kPulseDuration) / kDecayTime);
  amplitude_ = std::clamp(std::max(vibration, pulse), 0.0, 1.0);
}

}  // namespace pcavr
