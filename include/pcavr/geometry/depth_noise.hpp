// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace pcavr {

/// Standard deviation of a depth measurement along the optical axis, by range and incidence:
/// std(z, a) = constant + quadratic (z - offset)^2 + grazing / sqrt(z) * a^2 / (pi/2 - a)^2,
/// with z in metres and a the angle between ray and surface normal [Nguyen, Izadi & Lovell 2012,
/// eq. 2 and 3; the defaults are their values for the Kinect v1].
struct DepthNoise {
  double constant = 0.0012;   ///< [m]
  double quadratic = 0.0019;  ///< [1/m]
  double offset = 0.4;        ///< [m]
  double grazing = 0.0001;    ///< [m^1.5]
  double min_depth = 0.3;     ///< [m]; smaller measurements are not used
  double max_depth = 5.0;     ///< [m]; larger measurements are not used

  /// For a surface at normal incidence [m].
  [[nodiscard]] double depth_std(double z) const {
    const double dz = z - offset;
    return constant + quadratic * dz * dz;
  }
  /// For a surface at the angle of `incidence` [rad], 0 to pi/2 [m].
  [[nodiscard]] double depth_std(double z, double incidence) const;
};

}  // namespace pcavr
