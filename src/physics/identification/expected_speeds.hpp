// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "pcavr/physics/identification/friction_posterior.hpp"

namespace pcavr::detail {

/// The speeds that are to be expected, given the measured ones [regression calibration, Carroll et
/// al. 2006]: about each push's mean, by the share of their variance that is not noise. A steady
/// push's noise says nothing of viscous friction, and would draw it to zero.
inline std::vector<FrictionSample> with_expected_speeds(std::span<const FrictionSample> measured) {
  std::vector<FrictionSample> samples(measured.begin(), measured.end());
  for (std::size_t begin = 0, end; begin < samples.size(); begin = end) {
    double mean = 0.0, variance = 0.0, noise = 0.0;
    for (end = begin; end < samples.size() && samples[end].push == samples[begin].push; ++end) {
      mean += samples[end].speed;
      noise += std::pow(samples[end].speed_std, 2);
    }
    mean /= static_cast<double>(end - begin);
    for (std::size_t i = begin; i < end; ++i) variance += std::pow(samples[i].speed - mean, 2);
    if (variance <= 0.0) continue;
    const double share = std::max(0.0, 1.0 - noise / variance);
    for (std::size_t i = begin; i < end; ++i) {
      samples[i].speed = mean + share * (samples[i].speed - mean);
      samples[i].speed_std *= std::sqrt(share);
    }
  }
  return samples;
}

}  // namespace pcavr::detail
