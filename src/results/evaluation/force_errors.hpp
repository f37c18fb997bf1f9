// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "pcavr/base/geometry/trajectory.hpp"
#include "pcavr/results/evaluation/options.hpp"

#include "phase_timeline.hpp"
#include "run_files.hpp"

namespace pcavr {

/// The rendered force against the force measured at the same instant.
struct ForceErrorList {
  std::vector<double> difference;  ///< rendered - measured [N]
  std::vector<double> relative;    ///< |difference| / measured, from min_relative_force on
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
                                       const PhaseTimeline& timeline,
                                       const ForceErrorOptions& options = {});

/// Motion of the tool in a contact.
enum class ContactTask { unknown, push, press, slotting };

/// "unknown", "push", "press", "slotting".
[[nodiscard]] std::string_view to_string(ContactTask task);

/// One contact from its first to its last sample, with its peak forces: as in paper B's table 3.
struct ContactPeak {
  Stamp begin;
  Stamp end;
  Stamp peak;                                 ///< of the measured force
  double measured = 0.0;                      ///< [N]
  double rendered = 0.0;                      ///< [N]
  std::optional<double> approach_speed = {};  ///< of the tip before it [m/s], where recorded
  std::optional<double> travel = {};  ///< [m] of the tip from the contact's begin to its peak
  ContactTask task = ContactTask::unknown;
};

/// Travel from which on a press deforms its object as paper B's soft ball, not as its plastic.
inline constexpr double kSoftTravel = 0.005;  // [m]
[[nodiscard]] bool is_soft_press(const ContactPeak& contact);

/// The tip's travel [m] from the contact's begin to its peak; nothing where it was not recorded.
[[nodiscard]] std::optional<double> travel_to_peak(const Trajectory& T_base_tool,
                                                   const ContactPeak& contact);

/// Samples more than `contact_gap` apart belong to different contacts. Both peaks are those of the
/// moving mean over `peak_half_width`: the maximum of a noisy series is biased. Contacts that never
/// reach `min_relative_force` (grazing or noise) are excluded.
[[nodiscard]] std::vector<ContactPeak> contact_peaks(const std::vector<ForceSample>& samples,
                                                     const ForceErrorOptions& options = {});

/// The tip's mean speed [m/s] over `approach_time` before `contact`; nothing where the tool's
/// motion does not cover it.
[[nodiscard]] std::optional<double> approach_speed(const Trajectory& T_base_tool, Stamp contact,
                                                   const ForceErrorOptions& options = {});

}  // namespace pcavr
