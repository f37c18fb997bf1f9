// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "identify_signals.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace pcavr {
namespace {

/// Above the acceleration of any tip: at 500 Hz it is a millimetre off a straight line.
constexpr double kMaxAcceleration = 250.0;  // [m/s^2]
/// Maximum error of a stamp, in mean sample intervals: observed with real drivers.
constexpr double kJitter = 2.0;

}  // namespace

std::vector<Eigen::Vector3d> without_spikes(std::span<const Eigen::Vector3d> points) {
  // Only far outliers: a tip's path is curved, and the smoothing reduces its noise.
  constexpr SpikeOptions kFarOutliers{.half_window = 3, .threshold = 12.0};
  std::vector<Eigen::Vector3d> clean(points.begin(), points.end());
  for (int axis = 0; axis < 3; ++axis) {
    const DespikedSignal signal = remove_spikes(axis_of(points, axis), kFarOutliers);
    for (const std::size_t i : signal.spikes) clean[i][axis] = signal.values[i];
  }
  return clean;
}

std::vector<double> find_jumps(std::span<const double> t, std::span<const Eigen::Vector3d> points) {
  std::vector<double> jumps;
  if (points.size() < 8) return jumps;
  double noise = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    noise = std::max(noise, estimate_noise_std(axis_of(points, axis)));
  }
  const double interval = mean_interval(t);
  for (std::size_t i = 2; i + 2 < points.size(); ++i) {
    // The step from i - 1 to i against the two around it.
    const double dt = t[i] - t[i - 1];
    const Eigen::Vector3d before = (points[i - 1] - points[i - 2]) / (t[i - 1] - t[i - 2]);
    const Eigen::Vector3d after = (points[i + 1] - points[i]) / (t[i + 1] - t[i]);
    const Eigen::Vector3d excess = points[i] - points[i - 1] - 0.5 * dt * (before + after);
    // Stamps of one stream jitter by an interval or two.
    const double jitter = kJitter * interval * std::max(before.norm(), after.norm());
    const double allowed = 12.0 * noise + kMaxAcceleration * dt * dt + jitter;
    const bool is_known = !jumps.empty() && t[i] - jumps.back() < 3.5 * dt;
    if (excess.norm() > allowed && !is_known) jumps.push_back(t[i]);
  }
  return jumps;
}

}  // namespace pcavr
