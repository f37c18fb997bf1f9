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

/// Faults of a recording's force and tool that the data show positively: another reading of them
/// (the other sign, other axes, another unit, another clock) explains where the tool touched and
/// what moved decisively better than the one as written. A recording that shows none of them may
/// still be too poor to identify anything from: that is for the findings to say.

/// What is known when faults are looked for.
struct FaultEvidence {
  const IdentificationInput& input;
  const Segmentation& found;
  std::span<const IdentifiedContact> contacts;
  std::span<const ContactEvidence> evidence;
  const PathView& tip;
  const ObjectPlaces& places;
};

/// Sign, axes, unit of the tool's positions or clock, where most contacts do not fit the objects.
[[nodiscard]] std::optional<Error> find_fault(const FaultEvidence& known);

/// The force's unit, by the mass that somebody weighed: by accelerations where these are
/// identified, else by the friction of pushes that moved the object.
[[nodiscard]] std::optional<Error> force_unit_fault(const IdentifiableObject& object,
                                                    const IdentifiedParameter& mass,
                                                    std::vector<double> friction_shares);

/// What to check where an object slides as few do, though nothing shows a fault; else empty.
[[nodiscard]] std::string doubtful_friction(std::vector<double> friction_shares);

/// Of a recording whose force shows no contact: its unit, where objects were pushed along all the
/// same; else what is missing.
[[nodiscard]] Error no_contact_error(const IdentificationInput& input, const PathView& tip);

/// Contacts whose force points past or out of the face touched: nothing is to be identified from
/// them. Says so in the contact's `left_out`.
void leave_out_misdirected(std::span<const ContactEvidence> evidence,
                           std::vector<IdentifiedContact>& contacts);

/// "t = 12.345 s".
[[nodiscard]] std::string at_time(double t);

}  // namespace pcavr
