// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include <Eigen/Core>

#include "pcavr/physics/identification/signals.hpp"
#include "pcavr/physics/inputs/input_options.hpp"

namespace pcavr {

/// The rules by which samples of a tip are rejected, for a recording and for a stream alike.

/// [s] Around a jump, over which the smoothing spreads it.
inline constexpr double kBadMargin = 0.1;
/// Rejected samples in a row that interpolation replaces; more are a dropout.
inline constexpr std::size_t kSingleSamples = 3;
/// The text about a jump or a dropout.
inline constexpr char kJumpReason[] = "the tool's pose jumps";

/// Options that find only far outliers: a tip's path is curved, and the smoothing reduces its
/// noise.
[[nodiscard]] inline SpikeOptions tip_spike_options(double noise) {
  constexpr double kSpikeThreshold = 12.0;
  constexpr double kMinNoise = 1e-6;  // [m] of a tip that is at rest to the last digit
  SpikeOptions options;
  options.threshold = kSpikeThreshold;
  options.noise = std::max(noise, kMinNoise);
  return options;
}

/// Whether an arm can drive along these successive samples of one axis [m]: then none of them is a
/// spike, however still the tip is around it. At 10 Hz a press is one sample. `interval` [s]: the
/// mean one.
[[nodiscard]] inline bool is_drivable(std::span<const double> values, double noise,
                                      double interval) {
  constexpr double kMaxArmAcceleration = 20.0;  // [m/s^2] of fast arms
  constexpr double kNoiseStds = 12.0;           // as of a spike
  const double max_difference = kMaxArmAcceleration * interval * interval + kNoiseStds * noise;
  for (std::size_t i = 2; i < values.size(); ++i) {
    if (std::abs(values[i] - 2.0 * values[i - 1] + values[i - 2]) > max_difference) return false;
  }
  return true;
}

/// Whether no arm goes from `last` to `point` in `duration` [s]. A tool that stays there for longer
/// than max_dropout is accepted.
[[nodiscard]] inline bool is_dropout(const Eigen::Vector3d& last, const Eigen::Vector3d& point,
                                     double duration, const InputOptions& options) {
  constexpr double kMaxStepNoise = 0.005;  // [m] margin for two samples shortly after each other
  const double reach = kMaxStepNoise + options.max_tool_speed * duration;
  return (point - last).norm() > reach && duration < options.max_dropout;
}

/// Whether the tip jumps between the second and the third of five samples, farther than a tip can
/// accelerate. `interval` [s]: the mean one.
[[nodiscard]] inline bool is_jump(std::span<const double, 5> t,
                                  std::span<const Eigen::Vector3d, 5> points, double noise,
                                  double interval, const InputOptions& options) {
  constexpr double kNoiseStds = 12.0;  // of a jump, as of a spike
  // The speed over the interval before or after a step; never over less than the mean interval: the
  // stamps of one stream jitter.
  const auto velocity = [&](std::size_t from, std::size_t to) {
    return Eigen::Vector3d((points[to] - points[from]) / std::max(t[to] - t[from], interval));
  };
  const double dt = std::max(t[2] - t[1], interval);
  const Eigen::Vector3d before = velocity(0, 1);
  const Eigen::Vector3d after = velocity(2, 3);
  const Eigen::Vector3d excess = points[2] - points[1] - 0.5 * (t[2] - t[1]) * (before + after);
  const double jitter = options.max_stamp_jitter * interval * std::max(before.norm(), after.norm());
  return excess.norm() > kNoiseStds * noise + options.max_tool_acceleration * dt * dt + jitter;
}

/// Whether a jump at `t` is the one at `last` again: seen with the samples around it.
[[nodiscard]] inline bool is_same_jump(double last, double t, double dt) {
  return t - last < 3.5 * dt;
}

}  // namespace pcavr
