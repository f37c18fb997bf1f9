// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pcavr/physics/contact/hunt_crossley.hpp"
#include "pcavr/physics/identification/parameter.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

struct BreakawayOptions {
  BreakawayOptions();
  /// [s] of the smoothing; at least three samples are used. The error at a sharp peak grows with
  /// its square, so the default is the minimum that brings 0.25 N at 500 Hz under 0.15 N (4 ms) and
  /// that three samples allow (6 ms).
  double half_width;
  double contact_threshold;  ///< smoothed force above this many of its stds: contact
  double guard;              ///< [s] newest interval, excluded from the line fit
  double alarm_threshold;    ///< shortfall below the line, in stds of the force, ...
  double alarm_share;        ///< ... and as a share of the line: both raise the alarm
  double peak_drop;          ///< the peak has passed when the force fell by this share, ...
  double flat_time;          ///< [s] ... or has not risen for this long
};
[[nodiscard]] OptionSection section_of(BreakawayOptions& options);

/// One push, until the object broke loose.
struct Breakaway {
  bool is_found = false;
  double t_contact = 0.0;     ///< [s] first touch, extrapolated back from the first detected force
  double t_alarm = 0.0;       ///< [s] the force left the line
  double t_decided = 0.0;     ///< [s] detection of drop or flatness, filter delay included
  double t = 0.0;             ///< [s] the force's peak; of several equal within noise, the first
  double force = 0.0;         ///< [N] there: the limiting static friction measured at the tool
  double std = 0.0;           ///< [N] of that force, from the sensor's noise
  double loading_rate = 0.0;  ///< [N/s] before the peak; breakaway depends on it
  double stiffness = 0.0;     ///< [N/m] slope of the line
  std::string reason;         ///< why none was found
};

/// Stress mutation analysis [paper C, SMA], automatic and without a prior press. The line of an
/// object at rest is fitted in the push itself, F = c0 + c1 d, without its newest samples; an alarm
/// (change detection) when the force stays below it by 5 stds and 3 %; then the force is tracked
/// to its peak, until it has dropped by 3 % or is flat. Paper C compares the push with the law of
/// an earlier press instead: 3 % of error in that stiffness gives biases down to -60 %. Each
/// decision is causal: it uses samples up to its own instant only.
[[nodiscard]] Breakaway find_breakaway(const ForceMotion& push,
                                       const BreakawayOptions& options = {});

/// Options for finding the friction's own limit in a push.
struct OnsetOptions {
  OnsetOptions();
  double min_displacement;  ///< [m] the object is surely moving: several position noises
  double rest_time;         ///< [s] of rest that the fit uses, and of candidates for the onset
  double moving_time;       ///< [s] of motion beyond `min_displacement` that the fit uses
  double half_width;        ///< [s] of the smoothing of position, and of the force at the onset
  /// Error of the onset's force, as a share of peak minus onset, where the object creeps before it
  /// slides.
  double creep_share;
  /// Share of the force due to acceleration above which the onset is searched.
  double max_acceleration_share;
};
[[nodiscard]] OptionSection section_of(OnsetOptions& options);

/// The friction's own limit [N]: the force at the instant the object began to move, which in a fast
/// push is well below the peak, because the object has to be accelerated. The onset is the one from
/// which M s'' = F - friction, with the measured force integrated twice, fits the object's
/// displacement best; nothing is differentiated. An object that creeps before it slides makes the
/// onset early and the force a few per cent low: the std includes that. Assign it to
/// Breakaway::force before limiting_friction() where pushes were fast. Not excited where there is
/// no clear onset. mass [kg].
[[nodiscard]] IdentifiedParameter friction_at_breakaway(const ForceMotion& push,
                                                        const Breakaway& breakaway,
                                                        const HuntCrossley& contact_law,
                                                        double mass,
                                                        const OnsetOptions& options = {});

/// [N] by which the force overshoots the limit of an object under constant friction: r sqrt(M / k),
/// while a contact of stiffness k is loaded at a rate r. mass M [kg].
[[nodiscard]] double inertial_overshoot(const Breakaway& breakaway, double mass);

/// Friction's own limit of one push [N], whatever its speed: the force at the peak less what
/// accelerated the object. While a contact of stiffness k is loaded at a rate r, an object under
/// constant friction overshoots by r sqrt(M / k) of force; friction that drops at once makes the
/// force drop, too. The truth lies between: the middle is returned, with the std of a uniform
/// distribution over that range. Where it is more than `max_acceleration_share` of the force,
/// friction_at_breakaway is more accurate, and used with a contact law; the line of the push's own
/// loading is none: by it the object rests until the force leaves the line, whenever it began to
/// move. Not excited where no breakaway was found. mass [kg] > 0.
[[nodiscard]] IdentifiedParameter limit_of_push(const ForceMotion& push, const Breakaway& breakaway,
                                                const std::optional<HuntCrossley>& contact_law,
                                                double mass, const OnsetOptions& options = {});

/// Options that decide which of repeated pushes count.
struct LimitingFrictionOptions {
  LimitingFrictionOptions();
  double max_std_ratio;      ///< std of a push over the median std: beyond, it is another kind
  double outlier_stds;       ///< distance from the median, in robust stds, of an outlier, ...
  double min_outlier_share;  ///< ... and as a share of the median: both make an outlier
};
[[nodiscard]] OptionSection section_of(LimitingFrictionOptions& options);

/// F_M of repeated pushes [paper C, eq. 9, 10], weighted by inverse variance: a fast push
/// determines the friction's own limit many times worse than a slow one. Weights by a random
/// effects model [Paule & Mandel 1982]; pushes of equal std get equal weights, and the paper's mean
/// and STD. Rejected as outliers: those with more than three times the median std, and of four or
/// more those far from the median (five robust stds and 5 %): creep that was mistaken for the
/// breakaway.
struct LimitingFriction {
  double mean = 0.0;                  ///< F_M [N]
  double std = 0.0;                   ///< STD over the pushes [N]: half the critical band
  double std_of_mean = 0.0;           ///< [N] of a single push: its own
  double loading_rate = 0.0;          ///< [N/s] mean; F_M is valid at about this rate
  double loading_rate_std = 0.0;      ///< [N/s]
  int pushes = 0;                     ///< that broke away and count
  std::vector<std::size_t> left_out;  ///< indices of those that broke away and do not count
  int missed = 0;                     ///< that did not break away
};

[[nodiscard]] LimitingFriction limiting_friction(std::span<const Breakaway> pushes,
                                                 const LimitingFrictionOptions& options = {});

}  // namespace pcavr
