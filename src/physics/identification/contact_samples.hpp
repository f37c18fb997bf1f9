// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "pcavr/physics/identification/contact_fit.hpp"

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
  /// The same interval to its ends and a little beyond, position and force as measured (without
  /// spikes): smoothing distorts the law where the tip penetrates within the filter's width.
  std::vector<ContactSample> raw;
  double position_noise = 0.0;      ///< [m] standard deviations of `raw`
  double force_noise = 0.0;         ///< [N]
  double onset = 0.0;               ///< [m] tool coordinate where the force was first detected
  double interval = 0.0;            ///< [s] between samples
  double half_width = 0.0;          ///< [s] of the smoothing
  double speed_noise = 0.0;         ///< [m/s] standard deviations of the smoothed derivatives
  double acceleration_noise = 0.0;  ///< [m/s^2]
};

/// The mean of at least one sample.
[[nodiscard]] ContactSample mean_of(std::span<const ContactSample> samples);

/// Despiked, smoothed, cut to the contact.
[[nodiscard]] PressSamples press_samples(const ForceMotion& press,
                                         const ContactFitOptions& options);

/// Mean squared misfit of a law, in units of the propagated noise of force and tip (reduced chi
/// squared). Distinguishes laws where the residual force cannot, because the tip's noise times the
/// stiffness dominates it.
[[nodiscard]] double normalised_misfit(const std::vector<PressSamples>& presses,
                                       const ContactFit& fit);

/// Fits F = k x^n + lambda x^n x' over k, lambda, n and the surface, one for all or one for each
/// press, by orthogonal distances (total least squares): both the force and the tip's position have
/// noise, and on a stiff contact the tip's is much larger; least squares of the force alone would
/// underestimate the stiffness. Of `options` the shared surface and the given exponent are used.
[[nodiscard]] ContactFit fit_hunt_crossley(const std::vector<PressSamples>& presses,
                                           const ContactFitOptions& options);

}  // namespace pcavr
