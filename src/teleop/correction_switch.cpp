// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/correction_switch.hpp"

#include <algorithm>
#include <cmath>

namespace pcavr {
namespace {

constexpr double kSigmas = 3.0;
constexpr double kMinGap = 5e-4;  // [m]
// Both sites detect a phase change some 25 ms apart at best [s].
constexpr double kPhasePersistence = 0.060;
constexpr double kForcePersistence = 0.040;
// Two frames of an ordinary camera [s].
constexpr double kGapPersistence = 0.030;
// A predicted phase may flicker; lapses this short do not reset a difference [s].
constexpr double kMaxLapse = 0.020;
constexpr double kRetryInterval = 0.1;  // [s]
constexpr double kMargin = 0.060;       // [s] after a round trip
constexpr double kGrowthFactor = 2.0;
constexpr double kMaxBackoffFactor = 3.0;

}  // namespace

std::optional<CorrectionSwitch::Finding> CorrectionSwitch::find(const SiteComparison& seen,
                                                                double factor) const {
  const double gap_limit = factor * std::clamp(kSigmas * seen.position_std,
                                               std::min(kMinGap, options_.position_tolerance),
                                               options_.position_tolerance);
  const double gap =
      seen.position_gap.value_or(0.0) / std::min(gap_limit, options_.position_tolerance);
  const double force_limit =
      factor * std::max(options_.force_tolerance * seen.robot_force, options_.force_floor);
  const double force = std::abs(seen.robot_force - seen.operator_force) / force_limit;

  if (seen.robot_slides != seen.operator_slides) {
    return Finding{CorrectionCase::phases_differ, 1.0 + gap, kPhasePersistence};
  }
  if (seen.robot_slides) {
    if (gap <= 1.0) return std::nullopt;
    return Finding{CorrectionCase::both_sliding, gap, kGapPersistence};
  }
  if (seen.robot_touches && seen.operator_touches) {
    if (force <= 1.0 && gap <= 1.0) return std::nullopt;
    return Finding{CorrectionCase::both_static_force, std::max(force, gap), kForcePersistence};
  }
  if (seen.robot_touches) {
    if (force <= 1.0) return std::nullopt;
    return Finding{CorrectionCase::touched_by_robot, force, kForcePersistence};
  }
  // Touched by neither: a pose error would cause a force error at the operator's next contact.
  const double force_error = seen.operator_touches ? force : 0.0;
  if (force_error <= 1.0 && gap <= 1.0) return std::nullopt;
  return Finding{CorrectionCase::touched_by_operator, std::max(force_error, gap),
                 kForcePersistence};
}

std::optional<CorrectionCase> CorrectionSwitch::evaluate(const SiteComparison& seen,
                                                         double traffic) {
  const double factor = std::clamp(traffic, 1.0, kMaxBackoffFactor);
  const std::optional<Finding> finding = find(seen, factor);
  if (!finding) return std::nullopt;
  PendingFinding& pending = pending_[static_cast<std::size_t>(finding->which)];
  if (seen.t - pending.last > kMaxLapse) pending.since = seen.t;
  pending.last = seen.t;
  pending.size = finding->size;
  if (seen.t - pending.since < finding->persistence || seen.t < pending.suppressed_until)
    return std::nullopt;
  const bool is_in_flight = seen.t < pending.in_flight_until;
  if (is_in_flight && pending.size < kGrowthFactor * pending.size_sent) return std::nullopt;
  return finding->which;
}

void CorrectionSwitch::note_nothing_to_send(CorrectionCase which, double t) {
  pending_[static_cast<std::size_t>(which)].suppressed_until = t + kRetryInterval;
}

void CorrectionSwitch::note_sent(CorrectionCase which, double t_sent) {
  PendingFinding& pending = pending_[static_cast<std::size_t>(which)];
  pending.in_flight_until = t_sent + options_.round_trip + kMargin;
  pending.size_sent = std::max(pending.size, 1.0);
  pending.last = -1e300;
}

}  // namespace pcavr
