// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pcavr/physics/friction/sliding_force.hpp"
#include "pcavr/physics/identification/parameter.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// One instant of a slide, smoothed: the power balance of the sliding object, divided by the mean
/// speed of its support. With the supporting points' speeds v_p, all under the same share of the
/// weight, the tool's force F at a contact point of velocity v_c feeds friction and acceleration:
///
///     F . v_c / mean|v_p| = M (v . a + k^2 w w') / mean|v_p| + mu M g + B mean(v_p^2) / mean|v_p|
///
/// with the centre's velocity v, the rotation w and the gyration radius k.
/// For pure translation this is paper C's eq. 11, and for any rotation it needs neither the limit
/// surface nor the friction of the tip.
struct FrictionSample {
  double t = 0.0;             ///< [s]
  double force = 0.0;         ///< [N] F . v_c / mean|v_p|
  double speed = 0.0;         ///< [m/s] mean(v_p^2) / mean|v_p|
  double acceleration = 0.0;  ///< [m/s^2] (v . a + k^2 w w') / mean|v_p|: of the whole body
  double force_std = 0.0;     ///< [N] noise; independent between samples
  double speed_std = 0.0;
  double acceleration_std = 0.0;
  /// Covariance of the noises of force and acceleration [N m/s^2]: the force's own shows in both,
  /// where the object's motion follows from the tip's by the contact's compression.
  double noise_covariance = 0.0;
  /// The sample before is of the same push, half a smoothing window earlier: their noises
  /// correlate.
  bool is_adjacent = false;
  /// Excess of the object's true speed [m/s] and acceleration [m/s^2] over these where the contact
  /// is stiffer by one std of its compliance: one cause for all samples.
  double speed_change = 0.0, acceleration_change = 0.0;
  /// The same excess where the contact is more damped by one std of its damping.
  double damping_speed_change = 0.0, damping_acceleration_change = 0.0;
  /// Share of the mean speed that is due to rotation: 1 - |v_centre| / mean|v_p|. It grows with the
  /// support's size, which is known only as well as the pressure's distribution.
  double rotation_share = 0.0;
  bool is_turning = false;  ///< then `acceleration` is rough, and does not identify the mass
  double travel = 0.0;      ///< [m] path since the sample before, of the support's points
  std::size_t push = 0;     ///< its number, ascending over the samples
};

/// Prior knowledge before the pushes. Each is a range that supports, tips and bodies of this kind
/// have; a parameter that the pushes do not excite keeps it, and widens the stds of the others.
/// Defaults, ranges and reasons: options.cpp.
struct FrictionPriors {
  FrictionPriors();
  double max_viscous;          ///< [N s/m] viscous friction: uniform from 0 to this
  double scatter;              ///< share: std of friction from push to push and place to place, ...
  double scatter_factor;       ///< ... log-normal with this median and this factor as its std
  double push_correlation;     ///< maximum correlation of successive pushes' friction
  double correlation_path;     ///< [m] of travel over which friction varies with the place
  double bias_std;             ///< [N] of the force's bias in one push
  double stribeck_share;       ///< by which friction at rest exceeds that of fast sliding, +- it
  double stribeck_speed;       ///< [m/s] over which it falls off, see stribeck_share
  double support_size_share;   ///< std of the support's size about the supposed one
  double mass_share;           ///< std of the weighed mass, as a share
  double min_coefficient;      ///< of friction: a mass that would need less is not identified
  std::optional<double> mass;  ///< [kg] weighed
  double gravity;              ///< [m/s^2]
};
[[nodiscard]] OptionSection section_of(FrictionPriors& priors);

struct FrictionPosterior {
  bool is_valid = false;  ///< at least one sample
  IdentifiedParameter mass, coulomb, viscous;
  /// mu, with the weighed mass where there is one, else M; not excited where neither is known.
  IdentifiedParameter coefficient;
  /// Covariance of mass, Coulomb force and viscous friction, in their units.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double scatter = 0.0;        ///< share of friction, from push to push
  double place_scatter = 0.0;  ///< and from place to place
  std::vector<SlidingForce> sliding_force;
  std::size_t samples = 0;
  std::size_t pushes = 0;  ///< with at least one sample
};

/// A posterior narrower than its prior by this factor is identified; for the mass, which has no
/// prior range, a std of a tenth of it.
inline constexpr double kIdentifiedFactor = 3.0;

/// Correlation of the friction at two places `travel` [m] apart along a push, which is a first
/// order autoregression. `correlation_path` [m] is twice its length: on a long path it then has as
/// many independent places as there are correlation paths.
[[nodiscard]] double place_correlation(double travel, double correlation_path);

/// The joint posterior of M, mu M g and B from all slides of one object, by Bayes' rule: viscous
/// friction and scatter on a grid, all that is linear in closed form, one random effect per push
/// [Gelman et al. 2013, Bayesian Data Analysis, ch. 5]. Values and stds are moments of the whole
/// posterior, so that what is not excited widens the std of its neighbours. Errors of speed and
/// acceleration count as errors of force (effective variance), outliers are weighed down. A mass
/// without `priors.mass` is not known better than the compliance by which the accelerations were
/// found. Pure function; deterministic.
[[nodiscard]] FrictionPosterior infer_friction(std::span<const FrictionSample> samples,
                                               const FrictionPriors& priors = {});

}  // namespace pcavr
