// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace pcavr {

// Correlation of the noises of two samples half a window of smooth()'s kernel (1 - u^2)^2 apart: of
// values, of their second derivatives, and of their first ones, which is that of values with second
// derivatives (by parts).
inline constexpr double kForceCorrelation = 0.201, kAccelerationCorrelation = -0.4375;
inline constexpr double kSpeedCorrelation = -0.484;
inline constexpr double kForceAccelerationCorrelation = kSpeedCorrelation;

struct DerivativeNoise {
  double rate = 0.0;
  double acceleration = 0.0;
};

/// Noise propagation: the std in the derivatives by smooth() of white noise on a signal. Integrals
/// of the squared derivatives of the kernel (15/16)(1 - u^2)^2, 15/7 and 22.5.
[[nodiscard]] inline DerivativeNoise derivative_noise(double noise, double half_width,
                                                      double interval) {
  const double cube = half_width * half_width * half_width;
  return {noise * std::sqrt(15.0 / 7.0 * interval / cube),
          noise * std::sqrt(22.5 * interval / (cube * half_width * half_width))};
}

}  // namespace pcavr
