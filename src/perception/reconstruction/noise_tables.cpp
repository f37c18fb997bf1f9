// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/reconstruction/noise_tables.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "perception/reconstruction/voxel_block.hpp"

namespace pcavr {
namespace {

float weight_of(const DepthNoise& noise, double z, double cosine) {
  const double ratio = noise.constant / noise.depth_std(z, std::acos(cosine));
  return std::max(1.0F, static_cast<float>(kWeightUnits * ratio * ratio));
}

}  // namespace

NoiseTables::NoiseTables(const DepthNoise& noise, double min_truncation, double stds)
    : noise_(noise) {
  const double step = (noise.max_depth - noise.min_depth) / (kNoiseDepths - 1);
  steps_per_metre_ = static_cast<float>(1.0 / step);
  for (int i = 0; i < kNoiseDepths; ++i) {
    const double z = noise.min_depth + i * step;
    const double depth_std = noise.depth_std(z);
    const double truncation_at_z = std::max(min_truncation, stds * depth_std);
    truncation_.push_back(static_cast<float>(truncation_at_z));
    free_margin_.push_back(static_cast<float>(truncation_at_z + 3.0 * depth_std));
    inverse_tolerance_.push_back(
        static_cast<float>(3.0 * std::numbers::sqrt2 * depth_std / (z * z)));
    if (i % kNoiseDepthsPerWeight != 0) continue;
    for (int c = 0; c < kNoiseCosines; ++c) {
      weight_.push_back(weight_of(noise, z, static_cast<double>(c) / (kNoiseCosines - 1)));
    }
  }
}

}  // namespace pcavr
