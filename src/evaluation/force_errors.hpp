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

/// Relative errors are told of measured forces from here on [N]. A force sensor's noise of 0.2 N is
/// a tenth of it, and a tenth is what a hand can tell [paper C]: below, a relative error says
/// nothing about the model.
inline constexpr double kMinJudgedForce = 2.0;

/// The force felt, against the force measured at the same instant.
struct ForceErrorList {
  std::vector<double> difference;  ///< felt - measured [N]
  std::vector<double> relative;    ///< |difference| / measured, from kMinJudgedForce on
};

/// |difference| [N].
[[nodiscard]] std::vector<double> magnitudes(const ForceErrorList& errors);

struct ForceErrors {
  std::array<ForceErrorList, kPhaseCount> by_phase;
  ForceErrorList in_contact;  ///< static, critical and sliding together
  ForceErrorList all;         ///< also where only the operator's site touches, or no phase is known
};

/// One object's, split by the phases of `timeline`, which may be empty.
[[nodiscard]] ForceErrors force_errors(const std::vector<ForceSample>& samples,
                                       const PhaseTimeline& timeline);

/// One contact from its first to its last sample, with the largest forces in it: what paper B's
/// table 3 compares.
struct ContactPeak {
  Stamp begin;
  Stamp end;
  double measured = 0.0;                      ///< [N]
  double felt = 0.0;                          ///< [N]
  std::optional<double> approach_speed = {};  ///< of the tip before it [m/s], where it was recorded
};

/// Samples further apart than 50 ms are of different contacts: rows come at the wrench's rate, and
/// the slowest force sensors in use give 100 Hz. Contacts that never reach kMinJudgedForce, a
/// tool that grazes or noise, are left out.
[[nodiscard]] std::vector<ContactPeak> contact_peaks(const std::vector<ForceSample>& samples);

/// The tip's mean speed [m/s] over the 50 ms before `contact`; nothing where the tool's motion does
/// not cover them. Shorter: the noise of the tool's pose (some 0.1 mm) is taken for motion.
[[nodiscard]] std::optional<double> approach_speed(const Trajectory& T_base_tool, Stamp contact);

}  // namespace pcavr
