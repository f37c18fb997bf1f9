// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/identification/signals.hpp"

#include <algorithm>

#include "pcavr/base/core/check.hpp"

namespace pcavr {

double mean_interval(std::span<const double> t) {
  PCAVR_REQUIRE(t.size() > 1, t.size());
  return (t.back() - t.front()) / static_cast<double>(t.size() - 1);
}

std::vector<double> axis_of(std::span<const Eigen::Vector3d> values, int axis) {
  std::vector<double> components(values.size());
  std::transform(values.begin(), values.end(), components.begin(),
                 [axis](const Eigen::Vector3d& value) { return value[axis]; });
  return components;
}

}  // namespace pcavr
