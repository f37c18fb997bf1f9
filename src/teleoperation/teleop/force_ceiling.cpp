// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/force_ceiling.hpp"

#include <algorithm>
#include <cmath>

namespace pcavr {

void ForceCeiling::Extreme::add(double force) {
  if (!value || force > *value) {
    value = force;
    run = longest = 0;
  }
  run = force == *value ? run + 1 : 0;
  longest = std::max(longest, run);
}

void ForceCeiling::add(const Eigen::Vector3d& force_base) {
  add_extremes(force_base);
  if (!is_at_extreme()) noise_.add(force_base);
}

void ForceCeiling::add_extremes(const Eigen::Vector3d& force_base) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    highest_[axis].add(force_base[static_cast<Eigen::Index>(axis)]);
    lowest_[axis].add(-force_base[static_cast<Eigen::Index>(axis)]);
  }
}

/// Whether the force is at an extreme again: a force that grows has ever new extremes.
bool ForceCeiling::is_at_extreme() const {
  const auto repeats = [](const Extreme& extreme) { return extreme.run > 1; };
  return std::any_of(highest_.begin(), highest_.end(), repeats) ||
         std::any_of(lowest_.begin(), lowest_.end(), repeats);
}

void ForceCeiling::restart(std::span<const Eigen::Vector3d> force_base) {
  highest_ = lowest_ = {};
  for (const Eigen::Vector3d& one : force_base) add_extremes(one);
}

std::optional<double> ForceCeiling::value() const {
  std::optional<double> ceiling;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double noise = noise_.std()[static_cast<Eigen::Index>(axis)];
    for (const Extreme& extreme : {highest_[axis], lowest_[axis]}) {
      const double force = std::abs(extreme.value.value_or(0.0));
      const bool is_far = noise > 0.0 && force > options_.min_extreme_ratio * noise;
      if (!is_far || extreme.longest < options_.min_samples) continue;
      ceiling = std::min(ceiling.value_or(force), force);
    }
  }
  return ceiling;
}

}  // namespace pcavr
