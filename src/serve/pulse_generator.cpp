// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pulse_generator.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/core/check.hpp"

namespace pcavr {
namespace {

constexpr double kLongAgo = 1e3;  // [s] no pulse or contact yet

}  // namespace

PulseGenerator::PulseGenerator(std::size_t bodies, double full_scale_force,
                               const VibrationOptions& options)
    : full_scale_force_(full_scale_force),
      options_(options),
      since_pulse_(kLongAgo),
      since_contact_(kLongAgo),
      was_static_(bodies, false) {
  PCAVR_REQUIRE(full_scale_force > 0.0, full_scale_force);
  PCAVR_REQUIRE(options.decay_time > 0.0, options.decay_time);
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
  const bool touches = state.touches_scan || state.touched_body.has_value();
  if (touches && since_contact_ > options_.min_time_without_contact) start_pulse();
  since_contact_ = touches ? 0.0 : since_contact_ + dt;
  for (std::size_t i = 0; i < was_static_.size(); ++i) {
    const MotionPhase phase = state.bodies[i].phase;
    if (phase == MotionPhase::sliding && was_static_[i]) start_pulse();
    was_static_[i] = phase == MotionPhase::static_contact || phase == MotionPhase::critical;
  }
  const double vibration =
      options_.max_vibration * std::min(1.0, state.force_base.norm() / full_scale_force_);
  const double pulse =
      std::exp(-std::max(0.0, since_pulse_ - options_.pulse_duration) / options_.decay_time);
  amplitude_ = std::clamp(std::max(vibration, pulse), 0.0, 1.0);
}

}  // namespace pcavr
