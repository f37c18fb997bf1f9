// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

namespace pcavr::simulation {

/// Friction between two surfaces by bristles that deflect and then slip: the LuGre model with
/// Stribeck effect [Canudas de Wit et al. 1995], elasto-plastic [Dupont et al. 2002] so that a load
/// below kElasticRatio of the limit only deflects the bristles (presliding) and does not cause
/// creep. All forces are divided by the normal force.
struct BristleLaw {
  double static_coefficient = 0.3;     ///< at breakaway
  double sliding_coefficient = 0.3;    ///< Coulomb friction
  double stribeck_speed = 0.002;       ///< [m/s]
  double breakaway_deflection = 3e-5;  ///< [m] bristle deflection at breakaway
  double damping = 0.0;                ///< [s/m] of the deflection; see bristle_damping

  /// [1/m]
  [[nodiscard]] double stiffness() const { return static_coefficient / breakaway_deflection; }
};

/// Ratio of the breakaway deflection below which bristles are elastic and do not slip (z_ba /
/// z_ss).
inline constexpr double kElasticRatio = 0.97;

/// Bristles damp only slow motion [m/s]; constant damping would add to the viscous friction
/// whenever the load changes.
inline constexpr double kBristleDampedSpeed = 0.005;

/// Half the critical damping for a body under its own weight [s/m], gravity [m/s^2].
[[nodiscard]] inline double bristle_damping(double stiffness, double gravity) {
  return std::sqrt(stiffness / gravity);
}

/// exp(-x) for x >= 0, to 5e-9, without the cost of std::exp where it is nearly 1 or 0.
[[nodiscard]] inline double fast_exp_minus(double x) {
  if (x < 1e-4) return 1.0 - x;
  return x > 40.0 ? 0.0 : std::exp(-x);
}

/// Integrates the bristles' `deflection` [m] over dt [s] at a relative velocity [m/s]; returns the
/// friction over the normal force, along +velocity (the resisting force is its opposite). Implicit
/// Euler in the slip term, so that any dt is stable.
template <int N>
Eigen::Matrix<double, N, 1> advance_bristles(const BristleLaw& law,
                                             const Eigen::Matrix<double, N, 1>& velocity, double dt,
                                             Eigen::Matrix<double, N, 1>& deflection) {
  const double square = velocity.squaredNorm();
  const double length = deflection.norm();
  const double loading = deflection.dot(velocity);
  double slip_rate = 0.0;  // [1/s]
  // Early exit for most bristles of a body at rest: at any speed the limit is at least Coulomb
  // friction.
  if (loading > 0.0 && length * law.stiffness() > kElasticRatio * law.sliding_coefficient) {
    const double coefficient =
        law.sliding_coefficient +
        (law.static_coefficient - law.sliding_coefficient) *
            fast_exp_minus(square / (law.stribeck_speed * law.stribeck_speed));
    const double limit = coefficient / law.stiffness();
    const double fraction =
        std::clamp((length / limit - kElasticRatio) / (1.0 - kElasticRatio), 0.0, 1.0);
    slip_rate = fraction * fraction * (3.0 - 2.0 * fraction) * loading / (length * limit);
  }
  const Eigen::Matrix<double, N, 1> deflected =
      (deflection + dt * velocity) / (1.0 + dt * slip_rate);
  const Eigen::Matrix<double, N, 1> rate = (deflected - deflection) / dt;
  deflection = deflected;
  return law.stiffness() * deflection +
         law.damping * fast_exp_minus(square / (kBristleDampedSpeed * kBristleDampedSpeed)) * rate;
}

}  // namespace pcavr::simulation
