// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "pcavr/geometry/depth_noise.hpp"

#include "reconstruction/noise_table_sizes.hpp"

namespace pcavr {

/// What fusion asks of the noise model for every pixel, tabulated over depth: within a step of
/// some 5 mm nothing changes by more than a hundredth.
class NoiseTables {
 public:
  /// `voxel_size` and the least `truncation` in metres.
  NoiseTables(const DepthNoise& noise, double voxel_size, double truncation);

  [[nodiscard]] const DepthNoise& noise() const { return noise_; }
  [[nodiscard]] float nearest() const { return static_cast<float>(noise_.nearest); }
  [[nodiscard]] float steps_per_metre() const { return steps_per_metre_; }

  /// Distance at which a measurement at depth z is cut off: its noise fits inside (3 sigma), with
  /// two voxels to spare for the zero crossing [m].
  [[nodiscard]] float truncation(float z) const { return truncation_[index(z)]; }
  /// How much nearer than a measurement at depth z space is free for certain [m].
  [[nodiscard]] float free_margin(float z) const { return free_margin_[index(z)]; }

  [[nodiscard]] const float* truncations() const { return truncation_.data(); }
  /// Largest difference of inverse depth by noise alone, 3 sigma of a difference [1/m].
  [[nodiscard]] const float* inverse_tolerances() const { return inverse_tolerance_.data(); }
  /// Weights, [depth / kNoiseDepthsPerWeight][cosine of the incidence * (kNoiseCosines - 1)].
  [[nodiscard]] const float* weights() const { return weight_.data(); }

 private:
  [[nodiscard]] std::size_t index(float z) const {
    const int step = static_cast<int>((z - nearest()) * steps_per_metre_);
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
