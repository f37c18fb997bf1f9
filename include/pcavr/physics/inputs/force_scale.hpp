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

/// Findings about the force's scale from two masses of each object.
struct ScaleFindings {
  /// Another unit; or several objects' masses that differ by the same factor, the force's.
  std::optional<InputFault> fault = {};
  std::vector<std::string> warnings = {};  ///< one object's mass, or its force, is wrong
};
[[nodiscard]] ScaleFindings check_force_scale(std::span<const WeighedObject> objects);

}  // namespace pcavr
