// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace pcavr {

/// Rate control: the deflection of a self-centring stick or cap is the tip's velocity.
struct RateOptions {
  /// [m/s] > 0 at full deflection. 0.15 m/s crosses a table in some seconds and still allows
  /// control to a millimetre at small deflections.
  double max_speed = 0.15;
  /// [m] > 0 of the tip ahead of the tool (anti-windup against walls). The maximum force of 5 N is
  /// reached within it on surfaces stiffer than 250 N/m.
  double max_lead = 0.02;
  /// [rad] about base's z, from its x axis: the operator's viewing direction. Pushing
  /// forward moves the tip in that direction.
  double facing = 0.0;
};

}  // namespace pcavr
