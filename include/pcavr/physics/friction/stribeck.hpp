// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace pcavr {

/// The share that is left at `speed` of the excess of the limiting static friction over the Coulomb
/// friction: 1 at rest [Stribeck 1902], in the form of Bo & Pavelescu [1982] with the exponent 2 of
/// the LuGre model's authors [Canudas de Wit et al. 1995]. `stribeck_speed` > 0 [m/s].
[[nodiscard]] inline double stribeck_share(double speed, double stribeck_speed) noexcept {
  const double ratio = speed / stribeck_speed;
  return std::exp(-ratio * ratio);
}

}  // namespace pcavr
