// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pcavr/physics/contact/hunt_crossley.hpp"
#include "pcavr/physics/identification/parameter.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// Inverts the contact law: the penetration d(t) [m] that causes the force, by implicit Euler steps
/// from an unloaded contact; 0 where the force is not positive. Stable for any step.
[[nodiscard]] std::vector<double> penetration_from_force(std::span<const double> t,
                                                         std::span<const double> force,
                                                         const HuntCrossley& contact_law);

struct SlidingOptions {
  SlidingOptions();
  double half_width;           ///< [s] of the smoothing; well below the modulation's period
  double min_speed;            ///< [m/s] below, it may be sticking: excluded
  double min_force;            ///< [N] below, the contact may be lost: excluded
  double min_acceleration;     ///< [m/s^2] rms; below, the mass is not excited
  double min_speed_change;     ///< [m/s] rms of the speed beyond what acceleration explains
  double settle;               ///< [s] excluded after a stop: friction has not settled
  double max_mass_share;       ///< std of an identified mass over its value
  double max_viscous_share;    ///< std of an identified viscous friction over its value
  double min_forgetting;       ///< see EstimatorOptions
  int error_window;            ///< [samples] see EstimatorOptions
  double gravity;              ///< [m/s^2]
  std::optional<double> mass;  ///< [kg] where known; used for mu where it is not excited
};
[[nodiscard]] OptionSection section_of(SlidingOptions& options);

/// The estimates over time, for plots.
struct SlidingHistory {
  double t = 0.0;
  double value[3] = {};  ///< mass, Coulomb force, viscous friction
  double std[3] = {};
  double measured = 0.0;   ///< [N] smoothed
  double estimated = 0.0;  ///< [N] by the parameters before this sample
};

struct SlidingIdentification {
  bool is_valid = false;        ///< enough sliding to identify the friction
  IdentifiedParameter mass;     ///< M [kg]
  IdentifiedParameter coulomb;  ///< mu M g [N]; with viscous not excited: all friction at `speed`
  IdentifiedParameter viscous;  ///< B [N s/m]
  IdentifiedParameter coefficient;  ///< mu, where M was identified or given
  double speed = 0.0;               ///< [m/s] mean
  double acceleration = 0.0;        ///< [m/s^2] rms
  double residual = 0.0;            ///< [N] rms of the smoothed force about the model
  double relative_error = 0.0;      ///< residual over the rms force
  std::size_t samples = 0;
  std::string proposal;  ///< a better motion where something was not excited; else empty
  std::vector<SlidingHistory> history;
};

/// M, mu M g and B from F = M a + mu M g sgn(v) + B v [paper C, eq. 11] by affRLS over pushes,
/// stops and lost contact excluded. The object's motion is the tool's less the penetration. All of
/// it is smoothed alike. What the motion does not excite is removed from the model, never guessed:
/// the mass first, then the separation of Coulomb and viscous friction.
[[nodiscard]] SlidingIdentification identify_sliding(std::span<const ForceMotion> pushes,
                                                     const HuntCrossley& contact_law,
                                                     const SlidingOptions& options = {});

}  // namespace pcavr
