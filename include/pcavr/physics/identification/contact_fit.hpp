// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/physics/identification/parameter.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

enum class ContactRegressor {
  mass_damper_spring,  ///< F = m x'' + b x' + k x
  hunt_crossley        ///< F = k x^n + lambda x^n x'
};

struct ContactFitOptions {
  ContactFitOptions();
  double half_width;  ///< [s] of the smoothing; at least three samples are used
  /// Contact where the smoothed force exceeds this many of its own stds.
  double contact_threshold;
  /// Hunt-Crossley: all presses meet the surface at the same coordinate, which makes the exponent
  /// several times more accurate. False for presses at different points.
  bool is_surface_shared;
  /// [s] > 0: each signal is detrended by its own moving mean over this half width (a high-pass),
  /// and only the linear law is fitted. For a tip that drifts over a surface while it oscillates,
  /// so that the penetration is not known. About one period of the oscillation.
  double drift_half_width;
  /// [s] half width of the moving mean about which a surface that moves under a modulated press is
  /// fitted, and of the force's local direction there. About one period.
  double moving_half_width;
  double moving_window;    ///< [s] of one stiffness of such a surface: some periods
  double min_moving_gain;  ///< of the residual force, for the surface to be taken as moving
  double max_exponent;     ///< of the Hunt-Crossley law
  double prior_exponent;   ///< what is known of it before the presses: normal, with this mean ...
  double prior_exponent_std;  ///< ... and this std
  double min_mass_stds;       ///< mass over its std: below, the contact's mass is not fitted
  double min_improvement;     ///< of the misfit, as a share, for the Hunt-Crossley law to be chosen
  /// >= 1: fixed, and only the Hunt-Crossley law of this exponent is fitted.
  std::optional<double> exponent;
  /// Std of a fixed exponent, whose share goes into all stds, as k has another value for another
  /// exponent. 0: the stds are those for exactly this exponent.
  double exponent_std = 0.0;
};
[[nodiscard]] OptionSection section_of(ContactFitOptions& options);

/// One law fitted to all presses together.
struct ContactFit {
  ContactRegressor regressor = ContactRegressor::mass_damper_spring;
  bool is_valid = false;          ///< enough samples, and the stiffness came out positive
  IdentifiedParameter mass;       ///< m [kg]; mass_damper_spring only, not fitted where not excited
  IdentifiedParameter damping;    ///< b [N s/m] or lambda [N s/m^(n+1)]
  IdentifiedParameter stiffness;  ///< k [N/m^n]
  /// n; 1 for mass_damper_spring, with the distance of the Hunt-Crossley fit's exponent from 1 as
  /// its std: a tie chooses the linear law, and does not make its exponent exact.
  IdentifiedParameter exponent;
  /// Relative std of the penetration by this law, from a quarter of the presses' largest force on:
  /// much smaller than that of k, whose errors those of n compensate.
  double penetration_std = 0.0;
  /// Covariance of stiffness, damping and exponent, in their units; zero where the law is linear.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  std::vector<double> surface;  ///< [m] tool coordinate at which x = 0, one for each press that
                                ///< touched
  double residual = 0.0;        ///< [N] rms of measured minus estimated, smoothed force
  double relative_error = 0.0;  ///< residual over the rms force
  std::size_t samples = 0;
};

struct ContactIdentification {
  ContactFit mass_damper_spring;
  ContactFit hunt_crossley;
  ContactRegressor chosen = ContactRegressor::mass_damper_spring;  ///< by the residual
  std::vector<std::size_t> touched;  ///< indices of presses in contact, in the order of `surface`
  std::string proposal;  ///< a better motion, where something was not excited; else empty

  [[nodiscard]] const ContactFit& best() const {
    return chosen == ContactRegressor::hunt_crossley ? hunt_crossley : mass_damper_spring;
  }
};

/// The contact law from presses against something that does not move away, at any number of speeds.
/// Both laws are fitted, with the surface's coordinate as an unknown; the one of the smaller
/// residual is chosen, the linear law where they are within `min_improvement` of each other (paper
/// C always takes the linear one: on a Hunt-Crossley contact that costs a few per cent of force).
/// Remove the time offset between force and tool first: it shifts the surface with the speed.
/// `local`: the same presses along the local direction of the force (along_local_force), by which a
/// surface that moves under them is fitted; where empty, along the one direction of `presses`.
[[nodiscard]] ContactIdentification identify_contact(std::span<const ForceMotion> presses,
                                                     const ContactFitOptions& options = {},
                                                     std::span<const ForceMotion> local = {});

}  // namespace pcavr
