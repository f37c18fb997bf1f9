// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace pcavr {

/// Response of the tip of a position-controlled arm to its setpoint: it falls short of it as a
/// damped oscillator (impedance; Hogan 1985) would be deflected by compliance * force + lag * speed
/// + acceleration_lag * acceleration, of the force that the tip exerts, and of the setpoint's
/// motion. An arm on a spring whose damper acts on the difference of both speeds has the
/// acceleration lag rate^-2, one with a computed torque none.
struct TipResponse {
  double compliance = 0.0;        ///< [m/N]; 0: not known, the tip follows at once
  double rate = 0.0;              ///< [rad/s] of the undamped oscillator
  double damping_ratio = 1.0;     ///< of its critical damping
  double lag = 0.0;               ///< [s]
  double acceleration_lag = 0.0;  ///< [s^2]
};

/// Whether an arm can be such, in the single precision of messages; beyond, data or the sender are
/// at fault. False for NaN.
[[nodiscard]] inline bool is_plausible(const TipResponse& response) noexcept {
  const auto is_within = [](double value, float max) {
    return std::abs(static_cast<float>(value)) <= max;
  };
  return response.compliance >= 0.0 && response.rate >= 0.0 && response.damping_ratio >= 0.0 &&
         is_within(response.compliance, 0.1F) &&  // [m/N]
         is_within(response.rate, 1e4F) &&        // [rad/s]
         is_within(response.damping_ratio, 100.0F) &&
         is_within(response.lag, 1.0F) &&             // [s], either sign: a setpoint may be ahead
         is_within(response.acceleration_lag, 1.0F);  // [s^2]
}

}  // namespace pcavr
