// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace pcavr {

/// How the tip of a position-controlled arm follows its setpoint: it falls short of it as a damped
/// oscillator (impedance; Hogan 1985) would be deflected by
/// compliance * force + lag * speed + acceleration_lag * acceleration, of the force that the tip
/// exerts, and of the setpoint's motion. An arm on a spring whose damper acts on the difference of
/// both speeds has the acceleration lag rate^-2, one with a computed torque none.
struct TipResponse {
  double compliance = 0.0;        ///< [m/N]; 0: not known, the tip follows at once
  double rate = 0.0;              ///< [rad/s] of the undamped oscillator
  double damping_ratio = 1.0;     ///< of its critical damping
  double lag = 0.0;               ///< [s]
  double acceleration_lag = 0.0;  ///< [s^2]
};

}  // namespace pcavr
