// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "pcavr/core/check.hpp"
#include "pcavr/identification/signals.hpp"

namespace pcavr {
namespace {

/// Samples in a row at the very same extreme: noise repeats itself now and then.
constexpr std::size_t kFlatSamples = 8;
/// A quiet or unused axis has no end to reach: in a million samples noise goes to five deviations,
/// and a coarse sensor may give that reading for a while.
constexpr double kEndOverNoise = 8.0;

/// Of the samples that are not at an end: there is none at the end itself.
double noise_between(const std::vector<double>& values, double least, double most) {
  std::vector<double> between;
  for (const double value : values) {
    if (value > least && value < most) between.push_back(value);
  }
  return noise_deviation(between);
}

}  // namespace

std::vector<SaturatedStretch> find_saturation(std::span<const double> t,
                                              std::span<const Eigen::Vector3d> force) {
  PCAVR_REQUIRE(t.size() == force.size());
  std::vector<SaturatedStretch> stretches;
  if (force.empty()) return stretches;
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<double> values = axis_of(force, axis);
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    const double noise = noise_between(values, *least, *most);
    for (const double extreme : {*least, *most}) {
      if (!(std::abs(extreme) > kEndOverNoise * noise) || noise == 0.0) continue;
      for (std::size_t i = 0; i < values.size(); ++i) {
        std::size_t end = i;
        while (end < values.size() && values[end] == extreme) ++end;
        if (end - i >= kFlatSamples) stretches.push_back({t[i], t[end - 1], std::abs(extreme)});
        i = std::max(i, end);
      }
    }
  }
  std::sort(stretches.begin(), stretches.end(),
            [](const auto& a, const auto& b) { return a.begin < b.begin; });
  return stretches;
}

}  // namespace pcavr
