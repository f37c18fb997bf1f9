// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "pcavr/base/geometry/image.hpp"

namespace pcavr::simulation {

/// A colour camera with a linear response, so that blur does not shift edges.
struct ColorSensor {
  double blur = 0.55;        ///< Gaussian of lens and pixel [px]
  double exposure = 225.0;   ///< level of radiance 1
  double vignetting = 0.18;  ///< loss in the corners
  double read_noise = 1.0;   ///< [levels]
  double shot_noise = 0.10;  ///< [levels], times the square root of the level
};

/// Exposes linear radiance to 8 bits. The noise depends on `seed` and the pixel only.
[[nodiscard]] ColorImage expose(const ColorSensor& sensor, const Image<Eigen::Vector3f>& radiance,
                                std::uint64_t seed);

}  // namespace pcavr::simulation
