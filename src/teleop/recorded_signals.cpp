// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/recorded_signals.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>

#include "pcavr/identification/path_view.hpp"
#include "pcavr/identification/signals.hpp"

namespace pcavr {
namespace {

// Faster than any arm that pushes things [m/s].
constexpr double kAbsurdSpeed = 3.0;
// Noise of two samples that lie close together must not look fast [m].
constexpr double kSmallStep = 0.005;
// A tool that stays where it jumped to for this long is there [s].
constexpr double kBelieved = 0.1;
// Half width [s]: a hand and an arm move below 10 Hz.
constexpr double kCommandSmoothing = 0.020;
// The spike filter looks at this many later samples.
constexpr int kSpikeWindow = 3;

}  // namespace

Eigen::Vector3d TipMotion::at(double time) const { return PathView(t, p_base).at(time); }

TipMotion clean_tip(const TeleopInput& input) {
  TipMotion tip;
  for (std::size_t i = 0; i < input.t_tool.size(); ++i) {
    const Eigen::Vector3d& p = input.p_base_tip[i];
    if (!tip.t.empty()) {
      const double passed = input.t_tool[i] - tip.t.back();
      const double reach = kSmallStep + kAbsurdSpeed * passed;
      if ((p - tip.p_base.back()).norm() > reach && passed < kBelieved) {
        if (tip.jumps++ == 0) tip.first_jump = input.t_tool[i];
        continue;
      }
    }
    tip.t.push_back(input.t_tool[i]);
    tip.p_base.push_back(p);
  }
  for (int axis = 0; axis < 3 && tip.t.size() > 2; ++axis) {
    tip.noise = std::max(tip.noise, noise_deviation(axis_of(tip.p_base, axis)));
  }
  return tip;
}

std::vector<Eigen::Vector3d> command_of(const TipMotion& tip, double start, double step,
                                        std::size_t count) {
  // At every other instant: in between, a hand bends the way by less than a micrometre.
  std::vector<double> at(count / 2 + 1);
  for (std::size_t k = 0; k < at.size(); ++k) {
    at[k] = start + 2.0 * step * static_cast<double>(k);
  }
  const double interval = mean_interval(tip.t);
  const double half_width = std::max(kCommandSmoothing, 3.0 * interval);
  std::vector<Eigen::Vector3d> command(count);
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<SmoothedSample> place =
        smooth(tip.t, axis_of(tip.p_base, axis), at, half_width);
    const auto value = [&](std::size_t k) {
      return place[k].is_valid ? place[k].value : tip.at(at[k])[axis];
    };
    for (std::size_t k = 0; k < count; ++k) {
      const bool is_between = k % 2 == 1 && k / 2 + 1 < at.size();
      command[k][axis] = is_between ? 0.5 * (value(k / 2) + value(k / 2 + 1)) : value(k / 2);
    }
  }
  return command;
}

std::string describe_jumps(const TipMotion& tip) {
  char text[128];
  std::snprintf(text, sizeof text,
                "the tool's pose jumps (%zu samples, the first at %.3f s): left out", tip.jumps,
                tip.first_jump);
  return text;
}

ForceSignal smooth_force(const TeleopInput& input, const TipMotion& tip, double offset) {
  ForceSignal signal;
  // Without ten samples there is nothing to smooth, and no push in them.
  if (input.t_force.size() < 10 || tip.t.size() < 2) return signal;
  for (const double stamp : input.t_force) signal.t.push_back(stamp - offset);
  const std::size_t count = signal.t.size();
  const double interval = mean_interval(signal.t);
  const double half_width = std::max(kSmoothing, 3.0 * interval);
  signal.lag = half_width + kSpikeWindow * interval;
  signal.clean_base.resize(count);
  signal.smooth_base.resize(count);
  signal.p_base_tip.resize(count);
  for (int axis = 0; axis < 3; ++axis) {
    const DespikedSignal clean =
        remove_spikes(axis_of(input.force_base, axis), {.half_window = kSpikeWindow});
    signal.noise = std::max(signal.noise, noise_deviation(clean.values));
    const std::vector<SmoothedSample> force = smooth(signal.t, clean.values, signal.t, half_width);
    const std::vector<SmoothedSample> place =
        smooth(tip.t, axis_of(tip.p_base, axis), signal.t, half_width);
    for (std::size_t i = 0; i < count; ++i) {
      signal.clean_base[i][axis] = clean.values[i];
      signal.smooth_base[i][axis] = force[i].is_valid ? force[i].value : clean.values[i];
      signal.p_base_tip[i][axis] = place[i].is_valid ? place[i].value : tip.at(signal.t[i])[axis];
    }
  }
  signal.correlated = correlated_samples(half_width, interval);
  signal.smooth_noise = std::sqrt(3.0) * signal.noise / std::sqrt(signal.correlated);
  return signal;
}

}  // namespace pcavr
