// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/physics/contact/hunt_crossley.hpp"
#include "pcavr/physics/identification/contact_fit.hpp"
#include "pcavr/physics/identification/friction_posterior.hpp"
#include "pcavr/physics/identification/limit_of_pushes.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// Plans the contacts that a next recording needs for the wished stds. The experiment is chosen by
/// the posterior that it alone would give [Chaloner & Verdinelli 1995, Bayesian experimental
/// design]. The planned contacts are simulated with the values known so far and the noise that was
/// measured, and go through the same inference as recorded ones. Pure functions; deterministic.

/// Stds wished, as shares of the values where nothing else is stated, and what a planned motion may
/// do. Defaults, ranges and reasons: options.cpp.
struct PlanOptions {
  PlanOptions();
  double mass_std;
  double coefficient_std;
  double viscous_std;
  double limit_std;
  double exponent_std;  ///< itself, no share; stiffness has another unit for another exponent
  double damping_std;
  double max_speed;       ///< [m/s] of the tip while it pushes
  double frequency;       ///< [Hz] of a slide's modulation
  double slide_distance;  ///< [m]
  double press_depth;     ///< [m] at most, of the tip's command below the surface
  double max_force;       ///< [N] of a press
  double arm_stiffness;   ///< [N/m] between command and tip
  double clearance;       ///< [m] of the tip above the objects between contacts
  int max_contacts;       ///< of one kind, per object
};
/// "identification.plan" in a configuration file.
[[nodiscard]] OptionSection section_of(PlanOptions& options);

/// A straight slide at a mean speed, modulated sinusoidally so that it never stops.
struct SlideMotion {
  double speed = 0.0;      ///< [m/s] mean
  double amplitude = 0.0;  ///< [m] of the modulation
  double frequency = 0.0;  ///< [Hz]
  double distance = 0.0;   ///< [m]
};
[[nodiscard]] SlideMotion planned_slide(const PlanOptions& options);

/// Noise of the samples of a slide after smoothing, and their distance.
struct SlideNoise {
  double interval = 0.0;          ///< [s] between samples: half a smoothing window
  double force_std = 0.0;         ///< [N]
  double speed_std = 0.0;         ///< [m/s]
  double acceleration_std = 0.0;  ///< [m/s^2]
};

struct SlidePlan {
  int slides = 0;
  bool is_enough = false;      ///< the wished stds are expected
  FrictionPosterior expected;  ///< from these slides alone
};

/// The fewest slides by which mass, coefficient and viscous friction get the wished stds; else
/// `max_contacts` of them. `known` has to be valid; `priors` are those that it was inferred with.
[[nodiscard]] SlidePlan plan_slides(const FrictionPosterior& known, const SlideNoise& noise,
                                    const FrictionPriors& priors, const PlanOptions& options);

struct LimitPlan {
  int pushes = 0;
  bool is_enough = false;
  double expected_std = 0.0;  ///< [N] of F_M
};

/// The fewest pushes to breakaway by which F_M gets the wished std. `push_std` [N] is that of one
/// push without the scatter between pushes, `common_std` [N] an error that all pushes share.
[[nodiscard]] LimitPlan plan_limits(const LimitOfPushes& known, double push_std, double common_std,
                                    const FrictionPriors& priors, const PlanOptions& options);

/// Noise of one sample of a press, not smoothed.
struct PressNoise {
  double interval = 0.0;   ///< [s]
  double force_std = 0.0;  ///< [N]
  double tip_std = 0.0;    ///< [m]
};

/// Presses at these speeds [m/s] make one series: damping and stiffness differ by them.
inline constexpr double kPressSpeeds[] = {0.005, 0.015, 0.04};

struct PressPlan {
  int series = 0;  ///< of presses at kPressSpeeds
  bool is_enough = false;
  /// Depth of the command below the surface [m]: not even a rigid arm exceeds `max_force`.
  double depth = 0.0;
  ContactFit expected;  ///< from these presses alone
};

/// The fewest series of presses by which the exponent, and the damping where it is known, get the
/// wished stds.
[[nodiscard]] PressPlan plan_presses(const HuntCrossley& known, const PressNoise& noise,
                                     const ContactFitOptions& fit, const PlanOptions& options);

}  // namespace pcavr
