// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "pcavr/base/geometry/depth_noise.hpp"

#include "perception/reconstruction/noise_table_sizes.hpp"

namespace pcavr {

/// The noise model's values for fusion, tabulated over depth: within a step of about 5 mm they
/// change by less than 1 %.
class NoiseTables {
 public:
  /// Truncates at `min_truncation` [m], or farther at `stds` standard deviations of depth.
  NoiseTables(const DepthNoise& noise, double min_truncation, double stds);

  [[nodiscard]] const DepthNoise& noise() const { return noise_; }
  [[nodiscard]] float min_depth() const { return static_cast<float>(noise_.min_depth); }
  [[nodiscard]] float steps_per_metre() const { return steps_per_metre_; }

  /// Truncation distance of a measurement at depth z [m].
  [[nodiscard]] float truncation(float z) const { return truncation_[index(z)]; }
  /// Distance in front of a measurement at depth z from which space is certainly free [m].
  [[nodiscard]] float free_margin(float z) const { return free_margin_[index(z)]; }

  [[nodiscard]] const float* truncations() const { return truncation_.data(); }
  /// Maximum difference of inverse depth by noise alone: 3 standard deviations of a difference
  /// [1/m].
  [[nodiscard]] const float* inverse_tolerances() const { return inverse_tolerance_.data(); }
  /// Weights, [depth / kNoiseDepthsPerWeight][cosine of the incidence * (kNoiseCosines - 1)].
  [[nodiscard]] const float* weights() const { return weight_.data(); }

 private:
  [[nodiscard]] std::size_t index(float z) const {
    const int step = static_cast<int>((z - min_depth()) * steps_per_metre_);
    return static_cast<std::size_t>(std::clamp(step, 0, kNoiseDepths - 1));
  }

  DepthNoise noise_;
  float steps_per_metre_;
  std::vector<float> truncation_;
  std::vector<float> free_margin_;
  std::vector<float> inverse_tolerance_;
  std::vector<float> weight_;
};

}  // namespace pcavr
