// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/median.hpp"
#include "pcavr/physics/identification/signals.hpp"

namespace pcavr {
namespace {

/// The same as median(), but sorts the values instead of a copy; faster for few values.
double median_in_place(std::vector<double>& values) {
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double value = values[i];
    std::size_t at = i;
    for (; at > 0 && values[at - 1] > value; --at) values[at] = values[at - 1];
    values[at] = value;
  }
  return values[values.size() / 2];
}

}  // namespace

double estimate_noise_std(std::span<const double> values) {
  std::vector<double> second;
  second.reserve(values.size());
  for (std::size_t i = 2; i < values.size(); ++i) {
    second.push_back(std::abs(values[i] - 2.0 * values[i - 1] + values[i - 2]));
  }
  // The second difference of white noise has the variance 1 + 4 + 1.
  return kStdOverMad * median(std::move(second)) / std::sqrt(6.0);
}

DespikedSignal remove_spikes(std::span<const double> values, const SpikeOptions& options) {
  PCAVR_REQUIRE(options.half_window >= 1, options.half_window);
  PCAVR_REQUIRE(options.threshold > 0.0, options.threshold);
  DespikedSignal result;
  result.values.assign(values.begin(), values.end());
  const auto half = static_cast<std::size_t>(options.half_window);
  const double noise = options.noise ? *options.noise : estimate_noise_std(values);
  std::vector<double> window;
  window.reserve(2 * half + 1);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t begin = i > half ? i - half : 0;
    const std::size_t end = std::min(values.size(), i + half + 1);
    window.assign(values.begin() + static_cast<std::ptrdiff_t>(begin),
                  values.begin() + static_cast<std::ptrdiff_t>(end));
    const double middle = median_in_place(window);
    const double distance = std::abs(values[i] - middle);
    // The local std is no smaller than the noise: within that, which nearly all are, it is not
    // needed.
    if (distance <= options.threshold * noise) continue;
    for (double& value : window) value = std::abs(value - middle);
    const double local_std = std::max(kStdOverMad * median_in_place(window), noise);
    if (distance > options.threshold * local_std) {
      result.values[i] = middle;
      result.spikes.push_back(i);
    }
  }
  return result;
}

}  // namespace pcavr
