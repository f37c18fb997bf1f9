// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/geometry/depth_noise.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pcavr {

double DepthNoise::depth_std(double z, double incidence) const {
  // The term diverges at 90 degrees.
  const double angle = std::clamp(incidence, 0.0, 89.0 * std::numbers::pi / 180.0);
  const double complement = 0.5 * std::numbers::pi - angle;
  return depth_std(z) + grazing / std::sqrt(z) * (angle * angle) / (complement * complement);
}

}  // namespace pcavr
