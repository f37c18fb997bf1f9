// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/correction_switch.hpp"

#include <algorithm>
#include <cmath>

namespace pcavr {
namespace {

constexpr double kSigmas = 3.0;
constexpr double kLeastGap = 5e-4;  // [m]
// Two sites see a phase change some 25 ms apart at best [s].
constexpr double kPhaseStands = 0.060;
constexpr double kForceStands = 0.040;
// Two frames of an ordinary camera [s].
constexpr double kGapStands = 0.030;
constexpr double kMargin = 0.060;  // [s] after a round trip
constexpr double kGrown = 2.0;
constexpr double kMostPatience = 3.0;

}  // namespace

std::optional<CorrectionSwitch::Finding> CorrectionSwitch::find(const SiteComparison& seen,
                                                                double factor) const {
  const double gap_limit =
      factor * std::clamp(kSigmas * seen.position_sigma, kLeastGap, options_.position_tolerance);
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
  const double factor = std::clamp(traffic, 1.0, kMostPatience);
  const std::optional<Finding> finding = find(seen, factor);
  if (!finding) {
    // A gap is known at frames only: between them its case neither stands nor falls.
    if (seen.position_gap || !standing_) standing_.reset();
    return std::nullopt;
  }
  if (standing_ != finding->which) {
    standing_ = finding->which;
    standing_since_ = seen.t;
  }
  standing_size_ = finding->size;
  if (seen.t - standing_since_ < finding->persistence || seen.t < silent_until_) {
    return std::nullopt;
  }
  const bool is_on_its_way = on_its_way_ == finding->which && seen.t < on_its_way_until_;
  if (is_on_its_way && finding->size < kGrown * size_on_its_way_) return std::nullopt;
  return finding->which;
}

void CorrectionSwitch::note_sent(CorrectionCase which, double t_sent) {
  on_its_way_ = which;
  on_its_way_until_ = t_sent + options_.round_trip + kMargin;
  size_on_its_way_ = std::max(standing_size_, 1.0);
  standing_.reset();
}

}  // namespace pcavr
