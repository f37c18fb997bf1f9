// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/correction_switch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcavr {
namespace {

// [s] New data take a few frames to change what there is to send: composing it costs time.
constexpr double kRetryInterval = 0.1;
// An error above this share of its size before is not corrected.
constexpr double kPersistingShare = 0.5;
// [s] Averaging after a correction: three frames of an ordinary camera.
constexpr double kEffectTime = 0.1;

}  // namespace

std::optional<CorrectionSwitch::Finding> CorrectionSwitch::find(const SiteComparison& seen,
                                                                double factor) const {
  const double gap_limit =
      factor * std::clamp(options_.position_stds * seen.position_std,
                          std::min(options_.min_position_error, options_.position_tolerance),
                          options_.position_tolerance);
  const double gap =
      seen.position_gap.value_or(0.0) / std::min(gap_limit, options_.position_tolerance);
  const double force_limit =
      factor * std::max(options_.force_tolerance * seen.robot_force, force_floor_);
  const double force = std::abs(seen.robot_force - seen.operator_force) / force_limit;

  if (seen.robot_slides != seen.operator_slides) {
    return Finding{CorrectionCase::phases_differ, 1.0 + gap, options_.phase_persistence};
  }
  if (seen.robot_slides) {
    if (gap <= 1.0) return std::nullopt;
    return Finding{CorrectionCase::both_sliding, gap, options_.position_persistence};
  }
  if (seen.robot_touches && seen.operator_touches) {
    if (force <= 1.0 && gap <= 1.0) return std::nullopt;
    return Finding{CorrectionCase::both_static_force, std::max(force, gap),
                   options_.force_persistence};
  }
  if (seen.robot_touches) {
    if (force <= 1.0) return std::nullopt;
    return Finding{CorrectionCase::touched_by_robot, force, options_.force_persistence};
  }
  // Touched by neither: a pose error would cause a force error at the operator's next contact.
  const double force_error = seen.operator_touches ? force : 0.0;
  if (force_error <= 1.0 && gap <= 1.0) return std::nullopt;
  return Finding{CorrectionCase::touched_by_operator, std::max(force_error, gap),
                 options_.force_persistence};
}

std::optional<CorrectionSwitch::Finding> CorrectionSwitch::find_sliding_force(
    const SiteComparison& seen, double factor) const {
  const bool both_slide = seen.robot_slides && seen.operator_slides;
  if (!both_slide || !seen.robot_touches || !seen.operator_touches) return std::nullopt;
  const double limit = factor * std::max(options_.force_tolerance * seen.robot_force, force_floor_);
  const double force = std::abs(seen.robot_force - seen.operator_force) / limit;
  if (force <= 1.0) return std::nullopt;
  return Finding{CorrectionCase::both_sliding, force, options_.force_persistence};
}

bool CorrectionSwitch::is_due(const Finding& finding, double t, PendingFinding& pending) const {
  if (t - pending.last > options_.max_lapse) pending.since = t;
  pending.last = t;
  pending.size = finding.size;
  if (t - pending.since < finding.persistence || t < pending.suppressed_until) return false;
  const bool is_in_flight = t < pending.in_flight_until;
  return !is_in_flight || pending.size >= options_.growth_factor * pending.size_sent;
}

std::optional<CorrectionCase> CorrectionSwitch::evaluate(const SiteComparison& seen,
                                                         double traffic) {
  observe_effect(seen);
  const double factor = std::clamp(traffic, 1.0, options_.max_threshold_factor);
  is_sliding_force_ = false;
  const std::optional<Finding> finding = find(seen, factor);
  if (finding && is_due(*finding, seen.t, pending_of(finding->which))) return finding->which;
  const std::optional<Finding> force = find_sliding_force(seen, factor);
  if (!force || !is_due(*force, seen.t, sliding_force_)) return std::nullopt;
  is_sliding_force_ = true;
  return force->which;
}

void CorrectionSwitch::note_nothing_to_send(CorrectionCase which, double t) {
  pending_of(which).suppressed_until = t + kRetryInterval;
}

void CorrectionSwitch::send_again() {
  for (PendingFinding& pending : pending_) {
    pending.in_flight_until = pending.suppressed_until = -std::numeric_limits<double>::infinity();
  }
}

bool CorrectionSwitch::forces_agree(const SiteComparison& seen) const {
  const double limit = std::max(options_.force_tolerance * seen.robot_force, force_floor_);
  return std::abs(seen.robot_force - seen.operator_force) <= limit;
}

void CorrectionSwitch::observe_effect(const SiteComparison& seen) {
  if (!seen.robot_slides) effect_ = {};
  if (!seen.robot_slides || !seen.operator_slides || !seen.position_gap) return;
  gap_ = *seen.position_gap;
  if (!effect_.is_received) return;
  if (!effect_.received) effect_.received = seen.t;
  if (seen.t - *effect_.received > kEffectTime) return;
  effect_.sum_after += seen.push_gap;
  ++effect_.count_after;
}

bool CorrectionSwitch::had_no_effect(CorrectionCase which) const {
  if (which != CorrectionCase::both_sliding || effect_.count_after == 0) return false;
  const double push_gap = std::abs(effect_.sum_after) / effect_.count_after;
  return push_gap > kPersistingShare * effect_.gap_sent &&
         gap_ < options_.growth_factor * effect_.gap_sent;
}

void CorrectionSwitch::note_received(std::uint8_t sequence) {
  if (effect_.awaited != sequence) return;
  effect_.awaited.reset();
  effect_.is_received = true;
}

void CorrectionSwitch::note_sent(CorrectionCase which, double t_sent, std::uint8_t sequence) {
  PendingFinding& pending = pending_of(which);
  if (which == CorrectionCase::both_sliding && !is_sliding_force_) {
    effect_ = {.awaited = sequence, .gap_sent = gap_};
  }
  pending.in_flight_until = t_sent + round_trip_ + options_.round_trip_margin;
  pending.size_sent = std::max(pending.size, 1.0);
  pending.last = -std::numeric_limits<double>::infinity();
  // Every correction contains the parameters that have changed: the force shows their effect later.
  sliding_force_.in_flight_until = pending.in_flight_until;
  sliding_force_.size_sent =
      is_sliding_force_ ? pending.size_sent : std::numeric_limits<double>::infinity();
}

}  // namespace pcavr
