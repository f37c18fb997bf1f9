// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace pcavr {

/// Standard deviation of a depth measurement along the optical axis, by range and incidence:
/// sigma(z, a) = constant + quadratic (z - offset)^2 + grazing / sqrt(z) * a^2 / (pi/2 - a)^2,
/// with z in metres and a the angle between ray and surface normal [Nguyen, Izadi & Lovell 2012,
/// eq. 2 and 3, where it is measured for the first Kinect; the defaults are theirs].
struct DepthNoise {
  double constant = 0.0012;   ///< [m]
  double quadratic = 0.0019;  ///< [1/m]
  double offset = 0.4;        ///< [m]
  double grazing = 0.0001;    ///< [m^1.5]
  double nearest = 0.3;       ///< [m]; nearer readings are not used
  double farthest = 5.0;      ///< [m]; farther readings are not used

  /// For a surface seen head-on [m].
  [[nodiscard]] double sigma(double z) const {
    const double beyond = z - offset;
    return constant + quadratic * beyond * beyond;
  }
  /// For a surface seen at `incidence` [rad], 0 to pi/2 [m].
  [[nodiscard]] double sigma(double z, double incidence) const;
};

}  // namespace pcavr
