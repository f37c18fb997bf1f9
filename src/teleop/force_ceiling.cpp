// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/force_ceiling.hpp"

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
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    highest_[static_cast<std::size_t>(axis)].add(force_base[axis]);
    lowest_[static_cast<std::size_t>(axis)].add(-force_base[axis]);
  }
}

std::optional<double> ForceCeiling::value(const Eigen::Vector3d& noise) const {
  std::optional<double> ceiling;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double axis_noise = noise[static_cast<Eigen::Index>(axis)];
    for (const Extreme& extreme : {highest_[axis], lowest_[axis]}) {
      const double force = std::abs(extreme.value.value_or(0.0));
      const bool is_far = axis_noise > 0.0 && force > options_.min_extreme_ratio * axis_noise;
      if (!is_far || extreme.longest < options_.min_samples) continue;
      ceiling = std::min(ceiling.value_or(force), force);
    }
  }
  return ceiling;
}

}  // namespace pcavr
