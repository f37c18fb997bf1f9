// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pcavr/identification/parameter.hpp"

namespace pcavr {

/// One instant of a slide, smoothed: the power balance of the sliding object, divided by the mean
/// speed of its support. With the supporting points' speeds v_p, all under the same share of the
/// weight, the tool's force F at a contact point of velocity v_c feeds friction and acceleration:
///
///     F . v_c / mean|v_p| = M a + mu M g + B mean(v_p^2) / mean|v_p|
///
/// For pure translation this is paper C's eq. 11, and for any rotation it needs neither the limit
/// surface nor the friction of the tip.
struct FrictionSample {
  double t = 0.0;             ///< [s]
  double force = 0.0;         ///< [N] F . v_c / mean|v_p|
  double speed = 0.0;         ///< [m/s] mean(v_p^2) / mean|v_p|
  double acceleration = 0.0;  ///< [m/s^2] of the centre, times its share of the mean speed
  double force_std = 0.0;     ///< [N] noise; independent between samples
  double speed_std = 0.0;
  double acceleration_std = 0.0;
  /// Share of the mean speed that is due to rotation: 1 - |v_centre| / mean|v_p|. It grows with the
  /// support's size, which is known only as well as the pressure's distribution.
  double rotation_share = 0.0;
  bool is_turning = false;  ///< then `acceleration` is rough, and does not identify the mass
  double travel = 0.0;      ///< [m] path since the sample before, of the support's points
  std::size_t push = 0;     ///< its number, ascending over the samples
};

/// What is known before the pushes. Each is a range that supports, tips and bodies of this kind
/// have; a parameter that the pushes do not excite keeps it, and widens the stds of the others.
struct FrictionPriors {
  double max_viscous = 40.0;  ///< [N s/m] viscous friction: uniform from 0 to this
  /// Std of friction from push to push, and from place to place on the support, as a share of it:
  /// log-normal with this median, ...
  double scatter = 0.02;
  double scatter_factor = 2.0;      ///< ... and this factor as its std
  double correlation_path = 0.020;  ///< [m] of travel over which friction varies with the place
  double bias_std = 0.02;           ///< [N] of the force's bias in one push
  /// Friction at rest exceeds that of fast sliding [Stribeck 1902]: by this share, +- the same, at
  /// speed 0, falling off with exp(-v / stribeck_speed).
  double stribeck_share = 0.04;
  double stribeck_speed = 0.003;     ///< [m/s]
  double support_size_share = 0.25;  ///< std of the support's size about the supposed one
  std::optional<double> mass = {};   ///< [kg] weighed
  double mass_share = 0.005;         ///< std of the weighed mass, as a share
};

/// The friction at a speed that occurred, whatever its split into Coulomb and viscous parts.
struct SlidingForce {
  double speed = 0.0;  ///< [m/s]
  double force = 0.0;  ///< [N] mu M g + B speed, and what a slow speed adds
  double std = 0.0;    ///< [N]
};

struct FrictionPosterior {
  bool is_valid = false;  ///< at least one sample
  IdentifiedParameter mass, coulomb, viscous;
  IdentifiedParameter coefficient;  ///< mu; not excited where neither mass is known
  /// Of mass, Coulomb force and viscous friction, in their units.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double scatter = 0.0;  ///< share of friction, from push to push
  std::vector<SlidingForce> sliding_force;
  std::size_t samples = 0;
  std::size_t pushes = 0;
};

/// A posterior narrower than its prior by this factor is identified; for the mass, which has no
/// prior range, a std of a tenth of it.
inline constexpr double kIdentifiedFactor = 3.0;

/// The joint posterior of M, mu M g and B from all slides of one object, by Bayes' rule: viscous
/// friction and scatter on a grid, all that is linear in closed form, one random effect per push
/// [Gelman et al. 2013, Bayesian Data Analysis, ch. 5]. Values and stds are moments of the whole
/// posterior, so that what is not excited widens the std of its neighbours. Errors of speed and
/// acceleration count as errors of force (effective variance), outliers are weighed down. Pure
/// function; deterministic.
[[nodiscard]] FrictionPosterior infer_friction(std::span<const FrictionSample> samples,
                                               const FrictionPriors& priors = {});

}  // namespace pcavr
