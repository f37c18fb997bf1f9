// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "pcavr/base/core/check.hpp"
#include "pcavr/physics/identification/signals.hpp"

namespace pcavr {
namespace {

/// Noise of the samples that are not saturated: saturated ones have no noise.
double noise_of_unsaturated(const std::vector<double>& values, double min, double max) {
  std::vector<double> unsaturated;
  for (const double value : values) {
    if (value > min && value < max) unsaturated.push_back(value);
  }
  return estimate_noise_std(unsaturated);
}

}  // namespace

std::vector<SaturatedInterval> find_saturation(std::span<const double> t,
                                               std::span<const Eigen::Vector3d> force,
                                               const SaturationOptions& options) {
  PCAVR_REQUIRE(t.size() == force.size());
  PCAVR_REQUIRE(options.min_samples >= 2, options.min_samples);
  const auto min_samples = static_cast<std::size_t>(options.min_samples);
  std::vector<SaturatedInterval> intervals;
  if (force.empty()) return intervals;
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<double> values = axis_of(force, axis);
    const auto [min, max] = std::minmax_element(values.begin(), values.end());
    const double noise = noise_of_unsaturated(values, *min, *max);
    for (const double extreme : {*min, *max}) {
      if (!(std::abs(extreme) > options.min_extreme_ratio * noise) || noise == 0.0) continue;
      for (std::size_t i = 0; i < values.size(); ++i) {
        std::size_t end = i;
        while (end < values.size() && values[end] == extreme) ++end;
        if (end - i >= min_samples) intervals.push_back({t[i], t[end - 1], std::abs(extreme)});
        i = std::max(i, end);
      }
    }
  }
  std::sort(intervals.begin(), intervals.end(),
            [](const auto& a, const auto& b) { return a.begin < b.begin; });
  return intervals;
}

}  // namespace pcavr
