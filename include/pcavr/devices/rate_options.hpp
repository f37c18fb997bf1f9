// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace pcavr {

/// How a stick or a cap that springs back moves a tip: its deflection is a velocity.
struct RateOptions {
  /// [m/s] > 0 at full deflection. A push at 0.15 m/s crosses a table in some seconds and can still
  /// be steered to a millimetre near the middle.
  double max_speed = 0.15;
  /// [m] > 0 of the tip ahead of the tool, or a stick held against a wall would wind up. A bounded
  /// force of 5 N is reached within it on all that is stiffer than 250 N/m.
  double max_lead = 0.02;
  /// [rad] about base's z, from its x axis: where the operator looks. Pushing away moves that way.
  double facing = 0.0;
};

}  // namespace pcavr
