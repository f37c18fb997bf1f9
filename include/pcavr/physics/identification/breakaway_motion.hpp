// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "pcavr/base/core/options.hpp"
#include "pcavr/physics/contact/hunt_crossley.hpp"
#include "pcavr/physics/identification/breakaway.hpp"
#include "pcavr/physics/identification/parameter.hpp"

namespace pcavr {

/// The known properties of a pushed object before its static limit is found.
struct PushedObject {
  HuntCrossley contact_law;     ///< stiffness > 0
  double compliance_std = 0.0;  ///< share, of the contact's compliance
  double damping_std = 0.0;     ///< [s/m] of the contact's damping over its stiffness
  double mass = 0.0;            ///< [kg] > 0
  double mass_std = 0.0;        ///< share
  /// Coulomb friction [N] > 0 and viscous friction [N s/m] while it slides, and their covariance,
  /// positive definite.
  Eigen::Vector2d sliding = Eigen::Vector2d::Zero();
  Eigen::Matrix2d sliding_covariance = Eigen::Matrix2d::Identity();
  double stribeck_speed = 0.0;  ///< [m/s] > 0 over which friction falls to that of sliding; median
};

/// Prior knowledge of breakaways. `NAME` with `NAME_factor` is log-normal: the median, and the
/// factor that is one std of the logarithm; the Stribeck speed's median is the object's. Defaults,
/// ranges and reasons: prior_options.cpp.
struct BreakawayPriors {
  BreakawayPriors();
  double excess;  ///< share: limiting static over Coulomb friction, less 1
  double excess_factor;
  double presliding;  ///< [m] that an object moves before friction has its full limit
  double presliding_factor;
  double stribeck_factor;
  double max_shortfall;   ///< share of the peak by which friction may fall short of its limit
  double compliance_std;  ///< share, of the contact's compliance by a push's loading
  double damping_std;     ///< [s/m] of a contact's damping over its stiffness, if not known
  double rate_share;      ///< std of F_M, as a share, of an object that is loaded in no time, ...
  double rate_duration;   ///< [s] ... and half of that if within this time
  double turning_onset;   ///< rim's travel by turning, over the centre's, that may hide all excess
};
[[nodiscard]] OptionSection section_of(BreakawayPriors& priors);

/// A push's limit with its own std, and the std [N] that it shares with the object's other pushes.
struct LimitOfMotion {
  IdentifiedParameter limit;
  double shared_std = 0.0;
};

/// Friction's own limit F_M of one push [N], whatever its speed, by the breakaway's equation of
/// motion: the object rests until bristles between it and its support slip, and then
///
///     M s'' = k d^n (1 + c d') - f - B s',   d = tip - s,
///     f -> Fc + (F_M - Fc) exp(-(s'/vs)^2) after some micrometres of presliding
///
/// [LuGre model: Canudas de Wit et al. 1995]. The measured force about its peak is fitted by F_M,
/// with the errors of all that is known beside it as unknowns that have a prior: tip (its noise,
/// smoothed), compliance, damping, Fc and B, vs, presliding. Of the posterior (Laplace's
/// approximation, wider where the model does not explain the force), the part is cut off that is
/// clearly above the peak, or below it by more than an object under constant friction overshoots
/// by. Not excited without a breakaway or with too few samples about it. Pure function;
/// deterministic.
[[nodiscard]] LimitOfMotion limit_by_motion(const ForceMotion& push, const Breakaway& breakaway,
                                            const PushedObject& object,
                                            const BreakawayPriors& priors = {});

}  // namespace pcavr
