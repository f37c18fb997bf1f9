// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pcavr/core/expected.hpp"

#include "identify_evidence.hpp"
#include "identify_parts.hpp"

namespace pcavr {

/// Faults of a recording's force and tool that the data show positively: another interpretation
/// (the other sign, other axes, another unit, another clock) explains where the tool touched and
/// what moved decisively better than the data as written. A recording without such a fault may
/// still be insufficient to identify a parameter: the findings report that.

/// The data from which faults are detected.
struct FaultEvidence {
  const IdentificationInput& input;
  const Segmentation& found;
  std::span<const IdentifiedContact> contacts;
  std::span<const ContactEvidence> evidence;
  const PathView& tip;
  const ObjectPoses& object_poses;
};

/// Detects a wrong sign, axes, unit of the tool's positions or clock, where most contacts do not
/// fit the objects.
[[nodiscard]] std::optional<Error> find_fault(const FaultEvidence& known);

/// Detects a wrong unit of the force by the object's given mass: by accelerations where the mass is
/// identified from these, else by the friction of pushes that moved the object.
[[nodiscard]] std::optional<Error> force_unit_fault(const IdentifiableObject& object,
                                                    const IdentifiedParameter& mass,
                                                    std::vector<double> friction_ratios);

/// A note on what to check where an object's friction is unusually low, but not a proven fault;
/// else empty.
[[nodiscard]] std::string doubtful_friction(std::vector<double> friction_ratios);

/// The error of a recording whose force shows no contact: the force's unit, where objects were
/// pushed nevertheless; else what is missing.
[[nodiscard]] Error no_contact_error(const IdentificationInput& input, const PathView& tip);

/// Excludes contacts whose force does not point into the face touched; the reason goes into the
/// contact's `left_out`.
void leave_out_misdirected(std::span<const ContactEvidence> evidence,
                           std::vector<IdentifiedContact>& contacts);

/// "t = 12.345 s".
[[nodiscard]] std::string at_time(double t);

}  // namespace pcavr
