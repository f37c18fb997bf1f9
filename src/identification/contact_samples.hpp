// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pcavr/identification/contact_fit.hpp"

namespace pcavr {

/// One instant of a press, all four filtered alike.
struct ContactSample {
  double position = 0.0;  ///< [m] into the object
  double speed = 0.0;
  double acceleration = 0.0;
  double force = 0.0;
};

struct PressSamples {
  std::vector<ContactSample> samples;  ///< in contact, away from its ends
  /// The same stretch to its ends, position and force as measured (but for spikes): a smoothed
  /// curve is no longer the law's where the tip sinks in within the filter's width.
  std::vector<ContactSample> raw;
  double position_noise = 0.0;      ///< [m] standard deviations of `raw`
  double force_noise = 0.0;         ///< [N]
  double onset = 0.0;               ///< [m] tool coordinate where the force was first seen
  double interval = 0.0;            ///< [s] between samples
  double half_width = 0.0;          ///< [s] of the smoothing
  double speed_noise = 0.0;         ///< [m/s] standard deviations of the smoothed derivatives
  double acceleration_noise = 0.0;  ///< [m/s^2]
};

/// Despiked, smoothed, cut to the contact.
[[nodiscard]] PressSamples press_samples(const ForceMotion& press,
                                         const ContactFitOptions& options);

/// Mean squared misfit of a law, in units of what the noise of force and tip makes of it. Tells
/// laws apart where the residual force can't, because the tip's noise times the stiffness drowns
/// it.
[[nodiscard]] double normalised_misfit(const std::vector<PressSamples>& presses,
                                       const ContactFit& fit);

/// F = k x^n + lambda x^n x' over k, lambda, n and the surface, one for all or one for each press.
/// By orthogonal distances: both the force and the tip's place have noise, and on a stiff contact
/// the tip's is the larger by far; least squares of the force alone takes it for softness. Of
/// `options` the shared surface and the given exponent count.
[[nodiscard]] ContactFit fit_hunt_crossley(const std::vector<PressSamples>& presses,
                                           const ContactFitOptions& options);

}  // namespace pcavr
