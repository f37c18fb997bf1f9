// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "pcavr/geometry/trajectory.hpp"

#include "phase_timeline.hpp"
#include "run_files.hpp"

namespace pcavr {

/// [N] Relative errors are only computed for measured forces from this one on. A force sensor's
/// noise of 0.2 N is a tenth of it, and a tenth is the just noticeable difference [paper C]: below,
/// a relative error depends on noise more than on the model.
inline constexpr double kMinRelativeForce = 2.0;

/// The rendered force against the force measured at the same instant.
struct ForceErrorList {
  std::vector<double> difference;  ///< rendered - measured [N]
  std::vector<double> relative;    ///< |difference| / measured, from kMinRelativeForce on
};

/// |difference| [N].
[[nodiscard]] std::vector<double> magnitudes(const ForceErrorList& errors);

struct ForceErrors {
  std::array<ForceErrorList, kPhaseCount> by_phase;
  ForceErrorList in_contact;  ///< static, critical and sliding together
  ForceErrorList all;  ///< also where only the operator's site is in contact, or no phase is known
};

/// One object's, split by the phases of `timeline`, which may be empty.
[[nodiscard]] ForceErrors force_errors(const std::vector<ForceSample>& samples,
                                       const PhaseTimeline& timeline);

/// One contact from its first to its last sample, with its peak forces: as in paper B's table 3.
struct ContactPeak {
  Stamp begin;
  Stamp end;
  double measured = 0.0;                      ///< [N]
  double rendered = 0.0;                      ///< [N]
  std::optional<double> approach_speed = {};  ///< of the tip before it [m/s], where recorded
};

/// Samples more than 50 ms apart belong to different contacts: rows are at the wrench's rate, and
/// the slowest force sensors in use have 100 Hz. Contacts that never reach kMinRelativeForce
/// (grazing or noise) are excluded.
[[nodiscard]] std::vector<ContactPeak> contact_peaks(const std::vector<ForceSample>& samples);

/// The tip's mean speed [m/s] over the 50 ms before `contact`; nothing where the tool's motion does
/// not cover them. Shorter: the noise of the tool's pose (some 0.1 mm) counts as motion.
[[nodiscard]] std::optional<double> approach_speed(const Trajectory& T_base_tool, Stamp contact);

}  // namespace pcavr
