// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcavr {

/// The contact law between tool and body as parameter files state it, of the penetration d >= 0 and
/// its rate d': F = k d^n + lambda d^n d' [Hunt & Crossley 1975; paper B, eq. 1], and where n is 1
/// F = k d + lambda d' (Kelvin-Voigt). For n > 1 the force neither jumps at impact nor pulls while
/// the two separate more slowly than k / lambda.
///
/// The functions below are the one home of this law. They neither allocate nor throw; any thread
/// may call them. Inline, as prediction and haptics call them in their 1 kHz loop.
struct HuntCrossley {
  double stiffness = 0.0;  ///< k [N/m^n], > 0
  double damping = 0.0;    ///< lambda [N s/m^(n+1)], n = 1: [N s/m]
  double exponent = 1.0;   ///< n >= 1; 1.5 for spheres [Hertz 1882]
};

/// d^n, without a power function where n is 1 or 1.5; 0 out of contact.
[[nodiscard]] inline double penetration_power(double penetration, double exponent) noexcept {
  if (!(penetration > 0.0)) return 0.0;
  if (exponent == 1.0) return penetration;
  if (exponent == 1.5) return penetration * std::sqrt(penetration);
  return std::pow(penetration, exponent);
}

/// Derivative of the force by the penetration's rate [N s/m], with d^n at hand.
[[nodiscard]] inline double damping_from_power(const HuntCrossley& law, double power) noexcept {
  return law.exponent == 1.0 ? law.damping : law.damping * power;
}
[[nodiscard]] inline double contact_damping(const HuntCrossley& law, double penetration) noexcept {
  return damping_from_power(law, penetration_power(penetration, law.exponent));
}

/// The force at rest [N]; 0 out of contact.
[[nodiscard]] inline double elastic_force(const HuntCrossley& law, double penetration) noexcept {
  return law.stiffness * penetration_power(penetration, law.exponent);
}

/// The penetration [m] at which the law gives this force [N] at rest; 0 where it is not positive.
[[nodiscard]] inline double static_penetration(const HuntCrossley& law, double force) noexcept {
  return std::pow(std::max(force, 0.0) / law.stiffness, 1.0 / law.exponent);
}

/// The force by the formula [N]: it may pull. For a penetration >= 0 [m] and its rate [m/s].
[[nodiscard]] inline double unclamped_contact_force(const HuntCrossley& law, double penetration,
                                                    double rate) noexcept {
  const double power = penetration_power(penetration, law.exponent);
  return law.stiffness * power + damping_from_power(law, power) * rate;
}

/// A contact's force and its derivatives.
struct ContactForce {
  double force = 0.0;      ///< [N], >= 0
  double stiffness = 0.0;  ///< derivative by the penetration [N/m]
  double damping = 0.0;    ///< derivative by its rate [N s/m]
};

/// The force at a penetration [m] and its rate [m/s], never pulling and at most `max_force` [N];
/// derivatives are zero where it is clamped.
[[nodiscard]] inline ContactForce contact_force(
    const HuntCrossley& law, double penetration, double rate,
    double max_force = std::numeric_limits<double>::infinity()) noexcept {
  if (!(penetration > 0.0)) return {};
  const double power = penetration_power(penetration, law.exponent);
  const double elastic = law.stiffness * power;
  const double damping = damping_from_power(law, power);
  const double force = elastic + damping * rate;
  if (!(force > 0.0)) return {};
  if (force >= max_force) return {max_force, 0.0, 0.0};
  const double power_part = law.exponent == 1.0 ? elastic : force;
  return {force, law.exponent * power_part / penetration, damping};
}

}  // namespace pcavr
