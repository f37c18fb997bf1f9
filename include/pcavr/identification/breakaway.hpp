// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "pcavr/identification/parameter.hpp"
#include "pcavr/identification/sliding.hpp"

namespace pcavr {

struct BreakawayOptions {
  /// [s] of the smoothing; at least three samples are taken. What it takes off a sharp peak grows
  /// with its square, so it is the least that brings 0.25 N at 500 Hz under 0.15 N (4 ms) and that
  /// three samples allow (6 ms).
  double half_width = 0.006;
  double contact_deviations = 6.0;  ///< smoothed force above this many deviations: contact
  double guard = 0.080;             ///< [s] newest stretch that the line is not fitted to
  double alarm_deviations = 5.0;    ///< shortfall below the line, in deviations of the force, ...
  double alarm_share = 0.03;        ///< ... and as a share of the line: both raise the alarm
  double peak_drop = 0.03;          ///< the peak is over when the force fell by this share, ...
  double flat_time = 0.080;         ///< [s] ... or did not rise any more for this long
};

/// One push, until the object gave way.
struct Breakaway {
  bool is_found = false;
  double t_contact = 0.0;  ///< [s] first touch, carried back from where the force was first seen
  double t_alarm = 0.0;    ///< [s] the force left the line
  double t_decided = 0.0;  ///< [s] when it was known: drop or flatness seen, filter delay included
  double t = 0.0;  ///< [s] the force's peak; of several that noise does not tell apart, the first
  double force = 0.0;         ///< [N] there: the limiting static friction as the tool feels it
  double deviation = 0.0;     ///< [N] of that force, from the sensor's noise
  double loading_rate = 0.0;  ///< [N/s] on the way up; breakaway depends on it
  double stiffness = 0.0;     ///< [N/m] slope of the line
  std::string reason;         ///< why none was found
};

/// Stress mutation analysis [paper C, SMA], without a hand and without a press. The line of an
/// object that stands still is fitted in the push itself, F = c0 + c1 d, its newest stretch left
/// out; an alarm when the force stays below it by 5 deviations and 3 %; then the force is followed
/// to its peak, until it has dropped by 3 % or gone flat. Paper C holds the push against the law of
/// an earlier press instead: 3 % of error in that stiffness give biases to -60 %. Each decision
/// uses samples up to its own instant only.
[[nodiscard]] Breakaway find_breakaway(const ForceMotion& push,
                                       const BreakawayOptions& options = {});

/// The friction's own limit [N]: the force at the instant the object began to move, which in a fast
/// push is well below the peak, because the object has to be accelerated. The onset is the one from
/// which M s'' = F - friction, with the measured force integrated twice, meets the object's way
/// best; nothing is differentiated. An object that creeps before it goes makes the onset early and
/// the force some per cents low: the deviation counts that. Put it in place of Breakaway::force
/// before limiting_friction() where pushes were fast. Not excited where no clear onset is there.
/// mass [kg].
[[nodiscard]] IdentifiedParameter friction_at_breakaway(const ForceMotion& push,
                                                        const Breakaway& breakaway,
                                                        const Compliance& compliance, double mass);

/// Friction's own limit of one push [N], whatever its speed: the force at the peak less what
/// accelerated the object. While a contact of stiffness k is loaded at a rate r, an object under
/// constant friction swings out by r sqrt(M / k) of force; friction that falls at once lets the
/// force fall, too. The truth lies between: in the middle, with the deviation of a value that is
/// somewhere in there. Where that is more than 5 % of the force, friction_at_breakaway says it
/// better. Not excited where no breakaway was found. mass [kg] > 0.
[[nodiscard]] IdentifiedParameter limit_of_push(const ForceMotion& push, const Breakaway& breakaway,
                                                const Compliance& compliance, double mass);

/// F_M of repeated pushes [paper C, eq. 9, 10], each weighted by what it is worth: a fast push
/// tells the friction's own limit many times worse than a slow one. Weights by random effects
/// [Paule & Mandel 1982]; pushes of equal deviations get equal weights, and the paper's mean and
/// STD. Those with more than three times the median deviation are left out, and of four or more
/// those far from the middle one (five robust deviations and 5 %): a creep that was taken for the
/// breakaway.
struct LimitingFriction {
  double mean = 0.0;                    ///< F_M [N]
  double deviation = 0.0;               ///< STD over the pushes [N]: half the critical band
  double deviation_of_mean = 0.0;       ///< [N] of a single push: its own
  double loading_rate = 0.0;            ///< [N/s] mean; F_M holds at about this rate
  double loading_rate_deviation = 0.0;  ///< [N/s]
  int pushes = 0;                       ///< that broke away and count
  std::vector<std::size_t> left_out;    ///< indices of those that broke away and do not count
  int missed = 0;                       ///< that did not break away
};

[[nodiscard]] LimitingFriction limiting_friction(std::span<const Breakaway> pushes);

}  // namespace pcavr
