// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

namespace pcavr::simulation {

/// Friction between two surfaces by bristles that bend and then slip: LuGre's law with Stribeck
/// effect [Canudas de Wit et al. 1995], elasto-plastic [Dupont et al. 2002] so that what is loaded
/// below kElasticShare of the limit only bends and never creeps. All over the normal force.
struct BristleLaw {
  double static_coefficient = 0.3;   ///< at breakaway
  double sliding_coefficient = 0.3;  ///< Coulomb's
  double stribeck_speed = 0.002;     ///< [m/s]
  double reach = 3e-5;               ///< [m] bent at breakaway
  double damping = 0.0;              ///< [s/m] against bending; see bristle_damping

  [[nodiscard]] double stiffness() const { return static_coefficient / reach; }  ///< [1/m]
};

/// Below this share of what they can bear, bristles don't slip.
inline constexpr double kElasticShare = 0.97;

/// Bristles damp only slow motion [m/s]; a damping that stayed would add to the viscous friction
/// whenever the load changes.
inline constexpr double kBristleDampedSpeed = 0.005;

/// Half critical for a body under its own weight [s/m], gravity [m/s^2].
[[nodiscard]] inline double bristle_damping(double stiffness, double gravity) {
  return std::sqrt(stiffness / gravity);
}

/// exp(-x) for x >= 0, to 5e-9, without the cost where it is nearly 1 or 0.
[[nodiscard]] inline double bell(double x) {
  if (x < 1e-4) return 1.0 - x;
  return x > 40.0 ? 0.0 : std::exp(-x);
}

/// Moves bristles bent by `bend` [m] on for dt [s] at a relative velocity [m/s]; returns the
/// friction over the normal force, along +velocity (what resists is its opposite). Implicit in what
/// slips, so that any dt is stable.
template <int N>
Eigen::Matrix<double, N, 1> advance_bristles(const BristleLaw& law,
                                             const Eigen::Matrix<double, N, 1>& velocity, double dt,
                                             Eigen::Matrix<double, N, 1>& bend) {
  const double square = velocity.squaredNorm();
  const double length = bend.norm();
  const double onward = bend.dot(velocity);
  double slip_rate = 0.0;  // [1/s]
  // Whatever the speed, the limit is not below Coulomb's: most bristles of a body at rest end here.
  if (onward > 0.0 && length * law.stiffness() > kElasticShare * law.sliding_coefficient) {
    const double coefficient =
        law.sliding_coefficient + (law.static_coefficient - law.sliding_coefficient) *
                                      bell(square / (law.stribeck_speed * law.stribeck_speed));
    const double limit = coefficient / law.stiffness();
    const double place =
        std::clamp((length / limit - kElasticShare) / (1.0 - kElasticShare), 0.0, 1.0);
    slip_rate = place * place * (3.0 - 2.0 * place) * onward / (length * limit);
  }
  const Eigen::Matrix<double, N, 1> bent = (bend + dt * velocity) / (1.0 + dt * slip_rate);
  const Eigen::Matrix<double, N, 1> rate = (bent - bend) / dt;
  bend = bent;
  return law.stiffness() * bend +
         law.damping * bell(square / (kBristleDampedSpeed * kBristleDampedSpeed)) * rate;
}

}  // namespace pcavr::simulation
