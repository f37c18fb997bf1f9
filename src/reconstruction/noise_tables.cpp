// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "reconstruction/noise_tables.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reconstruction/voxel_block.hpp"

namespace pcavr {
namespace {

float weight_of(const DepthNoise& noise, double z, double cosine) {
  const double ratio = noise.constant / noise.sigma(z, std::acos(cosine));
  return std::max(1.0F, static_cast<float>(kWeightUnits * ratio * ratio));
}

}  // namespace

NoiseTables::NoiseTables(const DepthNoise& noise, double voxel_size, double truncation)
    : noise_(noise) {
  const double step = (noise.farthest - noise.nearest) / (kNoiseDepths - 1);
  steps_per_metre_ = static_cast<float>(1.0 / step);
  for (int i = 0; i < kNoiseDepths; ++i) {
    const double z = noise.nearest + i * step;
    const double sigma = noise.sigma(z);
    const double reach = std::max(truncation, 3.0 * sigma + 2.0 * voxel_size);
    truncation_.push_back(static_cast<float>(reach));
    free_margin_.push_back(static_cast<float>(reach + 3.0 * sigma));
    inverse_tolerance_.push_back(static_cast<float>(3.0 * std::numbers::sqrt2 * sigma / (z * z)));
    if (i % kNoiseDepthsPerWeight != 0) continue;
    for (int c = 0; c < kNoiseCosines; ++c) {
      weight_.push_back(weight_of(noise, z, static_cast<double>(c) / (kNoiseCosines - 1)));
    }
  }
}

}  // namespace pcavr
