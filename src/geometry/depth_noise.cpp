// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/geometry/depth_noise.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pcavr {

double DepthNoise::sigma(double z, double incidence) const {
  // At 89 degrees the term has grown 8000-fold; beyond, it would only overflow.
  const double angle = std::clamp(incidence, 0.0, 89.0 * std::numbers::pi / 180.0);
  const double left = 0.5 * std::numbers::pi - angle;
  return sigma(z) + grazing / std::sqrt(z) * (angle * angle) / (left * left);
}

}  // namespace pcavr
