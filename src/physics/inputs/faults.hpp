// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pcavr/physics/identification/parameter.hpp"
#include "pcavr/physics/identification/path_view.hpp"
#include "pcavr/physics/inputs/input_findings.hpp"

#include "physics/inputs/body_poses.hpp"
#include "physics/inputs/evidence.hpp"

namespace pcavr {

/// Another interpretation of the force's axes that explains where the tool touched and what moved,
/// where most contacts from above or most of those from the side do not fit.
[[nodiscard]] std::optional<InputFault> axes_fault(std::span<const ContactEvidence> evidence);

/// Excludes contacts whose force does not point into the face touched; the reason goes into the
/// contact's `left_out`.
void leave_out_misdirected(std::span<const ContactEvidence> evidence,
                           std::vector<Contact>& contacts);

inline constexpr std::size_t kOtherLengthUnits = 3;

/// The number of contacts that have the tip at a body, by the unit of the tool's positions.
struct UnitTouches {
  std::size_t contacts = 0;
  std::size_t in_metres = 0;
  std::array<std::size_t, kOtherLengthUnits> in_other_units{};  ///< mm, cm, km

  void add(const UnitTouches& other);
};
[[nodiscard]] UnitTouches count_unit_touches(const InputSeries& series,
                                             std::span<const Contact> contacts,
                                             std::span<const ContactEvidence> evidence,
                                             const PathView& tip, const BodyPoses& poses);
[[nodiscard]] std::optional<InputFault> tool_unit_fault(const UnitTouches& touches);

/// Friction over weight in the pushes of one body that moved it.
struct FrictionRatios {
  std::vector<double> ratios = {};
  bool is_weighed = true;  ///< false: with the mass that the body's volume suggests, or more
};
[[nodiscard]] std::optional<InputFault> force_unit_fault(const std::string& name,
                                                         const FrictionRatios& friction);
/// A fault of the force's unit where the mass that was identified from accelerations, `mass`, is
/// that of another unit than the weighed one [kg].
[[nodiscard]] std::optional<InputFault> force_unit_fault(const std::string& name,
                                                         double weighed_mass,
                                                         const IdentifiedParameter& mass);
/// A note on what to check where an object's friction is unusually low, but not a proven fault;
/// else empty.
[[nodiscard]] std::string doubtful_friction(const std::string& name,
                                            const FrictionRatios& friction);

/// The closest approach of the tip to one body, the farthest, and the body's motion near the tip.
struct Approach {
  double gap = std::numeric_limits<double>::infinity();       ///< [m] minimum
  double t = 0.0;                                             ///< [s] of the minimum
  double max_gap = -std::numeric_limits<double>::infinity();  ///< [m]
  double moved = 0.0;      ///< [m] by tracking, while the tip was near
  double max_force = 0.0;  ///< [N] horizontal, at that time
};
/// The approaches of the tip to all bodies.
[[nodiscard]] std::vector<Approach> approaches_of(const InputSeries& series, const PathView& tip,
                                                  const BodyPoses& poses);

/// A recording whose force shows no contact: the force's unit is a fault where bodies were pushed
/// nevertheless; else what is missing.
struct NoContact {
  Error error;
  bool is_unit_fault = false;
};
[[nodiscard]] NoContact explain_no_contact(const std::vector<InputBody>& bodies,
                                           std::span<const Approach> approaches);

}  // namespace pcavr
