// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "pcavr/core/check.hpp"
#include "pcavr/identification/signals.hpp"

namespace pcavr {
namespace {

// Spread of the up vector (rms, as a sine) from which turning tells weight from bias: 6 degrees.
constexpr double kLeastTurn = 0.1;

Eigen::Vector3d mean(std::span<const Eigen::Vector3d> vectors) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& vector : vectors) sum += vector;
  return sum / static_cast<double>(vectors.size());
}

}  // namespace

SensorLoad estimate_sensor_load(std::span<const Eigen::Vector3d> force_sensor,
                                std::span<const Eigen::Vector3d> up_sensor) {
  PCAVR_REQUIRE(force_sensor.size() == up_sensor.size(), force_sensor.size(), up_sensor.size());
  SensorLoad load;
  if (force_sensor.empty()) return load;
  const double count = static_cast<double>(force_sensor.size());
  const Eigen::Vector3d mean_force = mean(force_sensor);
  const Eigen::Vector3d mean_up = mean(up_sensor);
  double turn = 0.0;
  double against = 0.0;
  for (std::size_t i = 0; i < force_sensor.size(); ++i) {
    const Eigen::Vector3d up = up_sensor[i] - mean_up;
    turn += up.squaredNorm();
    against -= up.dot(force_sensor[i] - mean_force);
  }
  load.is_weight_known = std::sqrt(turn / count) >= kLeastTurn;
  if (load.is_weight_known) load.weight = against / turn;
  load.bias_sensor = mean_force + load.weight * mean_up;
  double sum = 0.0;
  for (std::size_t i = 0; i < force_sensor.size(); ++i) {
    sum += without_load(force_sensor[i], up_sensor[i], load).squaredNorm();
  }
  load.residual = std::sqrt(sum / count);
  const double freedom = std::max(3.0 * count - 4.0, 1.0);
  if (load.is_weight_known) load.weight_deviation = std::sqrt(sum / freedom / turn);
  return load;
}

Eigen::Vector3d without_load(const Eigen::Vector3d& force_sensor, const Eigen::Vector3d& up_sensor,
                             const SensorLoad& load) {
  return force_sensor + load.weight * up_sensor - load.bias_sensor;
}

std::vector<Eigen::Vector3d> track_bias(std::span<const double> t,
                                        std::span<const Eigen::Vector3d> force,
                                        const std::vector<bool>& is_free, double half_width) {
  PCAVR_REQUIRE(t.size() == force.size() && t.size() == is_free.size());
  PCAVR_REQUIRE(half_width > 0.0, half_width);
  const std::size_t count = t.size();
  std::vector<Eigen::Vector3d> bias(count, Eigen::Vector3d::Zero());
  std::vector<std::size_t> known;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  std::size_t begin = 0, end = 0, free = 0;
  for (std::size_t i = 0; i < count; ++i) {
    for (; end < count && t[end] <= t[i] + half_width; ++end) {
      if (is_free[end]) sum += force[end], ++free;
    }
    for (; t[begin] < t[i] - half_width; ++begin) {
      if (is_free[begin]) sum -= force[begin], --free;
    }
    if (!is_free[i]) continue;
    bias[i] = sum / static_cast<double>(free);
    known.push_back(i);
  }
  if (known.empty()) return bias;
  std::size_t next = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (is_free[i]) continue;
    while (next < known.size() && known[next] < i) ++next;
    const std::size_t after = known[std::min(next, known.size() - 1)];
    const std::size_t before = known[next > 0 ? next - 1 : 0];
    const double span = t[after] - t[before];
    const double share = span > 0.0 ? (t[i] - t[before]) / span : 0.0;
    bias[i] = bias[before] + std::clamp(share, 0.0, 1.0) * (bias[after] - bias[before]);
  }
  return bias;
}

}  // namespace pcavr
