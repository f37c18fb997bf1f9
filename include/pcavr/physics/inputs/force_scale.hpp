// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pcavr/physics/identification/parameter.hpp"
#include "pcavr/physics/inputs/input_findings.hpp"

namespace pcavr {

/// An object that was weighed and whose mass was identified from force and acceleration.
struct WeighedObject {
  std::string name;
  double weighed_mass = 0.0;      ///< [kg]
  IdentifiedParameter mass = {};  ///< [kg] without the weighed one
};

/// What is identified by a force of another scale; for messages.
inline constexpr char kForceScaleEffect[] =
    "a force of k times the true one gives k times F_M, sliding and viscous friction and stiffness";

/// The mass by force and acceleration over the weighed one, where that is no chance: the weighed
/// one has a std of 2 %.
struct ScaleDoubt {
  double factor = 1.0;
  /// The part of the factor that stds have to contain: from 1 where it may be chance, to all of it.
  double doubted_factor = 1.0;
};
[[nodiscard]] std::optional<ScaleDoubt> doubt_of_scale(const WeighedObject& object);

/// Findings about the force's scale from two masses of each object.
struct ScaleFindings {
  /// Another unit; or several objects' masses that differ by the same factor, the force's.
  std::optional<InputFault> fault = {};
  std::vector<std::string> warnings = {};  ///< one object's mass, or its force, is wrong
  std::vector<std::string> notes = {};     ///< no object has both masses
};
[[nodiscard]] ScaleFindings check_force_scale(std::span<const WeighedObject> objects);

}  // namespace pcavr
