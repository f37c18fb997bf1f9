// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// Standard deviation of a depth measurement along the optical axis, by range and incidence:
/// std(z, a) = constant + quadratic (z - offset)^2 + grazing / sqrt(z) * a^2 / (pi/2 - a)^2,
/// with z in metres and a the angle between ray and surface normal [Nguyen, Izadi & Lovell 2012,
/// eq. 2 and 3; the defaults are their values for the Kinect v1].
struct DepthNoise {
  DepthNoise();
  /// The default noise of a sensor that measures from `min_depth` to `max_depth` [m].
  DepthNoise(double min_depth, double max_depth);

  double constant;   ///< [m]
  double quadratic;  ///< [1/m]
  double offset;     ///< [m]
  double grazing;    ///< [m^1.5]
  double min_depth;  ///< [m]
  double max_depth;  ///< [m]

  /// Standard deviation [m] of the depth of a surface at normal incidence.
  [[nodiscard]] double depth_std(double z) const {
    const double dz = z - offset;
    return constant + quadratic * dz * dz;
  }
  /// Standard deviation [m] of the depth of a surface at the angle of `incidence` [rad], 0 to pi/2.
  [[nodiscard]] double depth_std(double z, double incidence) const;
};

/// The options "depth_noise".
[[nodiscard]] OptionSection section_of(DepthNoise& noise);

}  // namespace pcavr
