// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/correction_switch.hpp"

#include <algorithm>
#include <cmath>

namespace pcavr {
namespace {

constexpr double kSigmas = 3.0;
constexpr double kMinGap = 5e-4;  // [m]
// Two sites see a phase change some 25 ms apart at best [s].
constexpr double kPhaseStands = 0.060;
constexpr double kForceStands = 0.040;
// Two frames of an ordinary camera [s].
constexpr double kGapStands = 0.030;
// A predicted phase may flicker; a difference stands through lapses this short [s].
constexpr double kLapse = 0.020;
constexpr double kAskAgain = 0.1;  // [s]
constexpr double kMargin = 0.060;  // [s] after a round trip
constexpr double kGrown = 2.0;
constexpr double kMaxPatience = 3.0;

}  // namespace

std::optional<CorrectionSwitch::Finding> CorrectionSwitch::find(const SiteComparison& seen,
                                                                double factor) const {
  const double gap_limit = factor * std::clamp(kSigmas * seen.position_sigma,
                                               std::min(kMinGap, options_.position_tolerance),
                                               options_.position_tolerance);
  const double gap =
      seen.position_gap.value_or(0.0) / std::min(gap_limit, options_.position_tolerance);
  const double force_limit =
      factor * std::max(options_.force_tolerance * seen.robot_force, options_.force_floor);
  const double force = std::abs(seen.robot_force - seen.operator_force) / force_limit;

  if (seen.robot_slides != seen.operator_slides) {
    return Finding{CorrectionCase::phases_differ, 1.0 + gap, kPhaseStands};
  }
  if (seen.robot_slides) {
    if (gap <= 1.0) return std::nullopt;
    return Finding{CorrectionCase::both_sliding, gap, kGapStands};
  }
  if (seen.robot_touches && seen.operator_touches) {
    if (force <= 1.0 && gap <= 1.0) return std::nullopt;
    return Finding{CorrectionCase::both_static_force, std::max(force, gap), kForceStands};
  }
  if (seen.robot_touches) {
    if (force <= 1.0) return std::nullopt;
    return Finding{CorrectionCase::touched_by_robot, force, kForceStands};
  }
  // Touched by neither, a wrong place is the operator's contact to come.
  const double felt = seen.operator_touches ? force : 0.0;
  if (felt <= 1.0 && gap <= 1.0) return std::nullopt;
  return Finding{CorrectionCase::touched_by_operator, std::max(felt, gap), kForceStands};
}

std::optional<CorrectionCase> CorrectionSwitch::judge(const SiteComparison& seen, double traffic) {
  const double factor = std::clamp(traffic, 1.0, kMaxPatience);
  const std::optional<Finding> finding = find(seen, factor);
  if (!finding) return std::nullopt;
  Matter& matter = matters_[static_cast<std::size_t>(finding->which)];
  if (seen.t - matter.last > kLapse) matter.since = seen.t;
  matter.last = seen.t;
  matter.size = finding->size;
  if (seen.t - matter.since < finding->persistence || seen.t < matter.silent_until)
    return std::nullopt;
  const bool is_on_its_way = seen.t < matter.on_its_way_until;
  if (is_on_its_way && matter.size < kGrown * matter.size_sent) return std::nullopt;
  return finding->which;
}

void CorrectionSwitch::note_silent(CorrectionCase which, double t) {
  matters_[static_cast<std::size_t>(which)].silent_until = t + kAskAgain;
}

void CorrectionSwitch::note_sent(CorrectionCase which, double t_sent) {
  Matter& matter = matters_[static_cast<std::size_t>(which)];
  matter.on_its_way_until = t_sent + options_.round_trip + kMargin;
  matter.size_sent = std::max(matter.size, 1.0);
  matter.last = -1e300;
}

}  // namespace pcavr
