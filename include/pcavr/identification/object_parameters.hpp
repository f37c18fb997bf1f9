// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>

#include "pcavr/friction/limit_surface.hpp"
#include "pcavr/identification/sliding.hpp"

namespace pcavr {

/// A number, and how far to trust it where that is known.
struct ParameterValue {
  double value = 0.0;
  std::optional<double> deviation = {};  ///< standard deviation, in the value's unit
};

/// All that is known of how an object yields and slides: what identification writes, prediction
/// reads and `truth/parameters.yaml` states. Empty: not known, because nothing told it.
struct ObjectParameters {
  std::optional<ParameterValue> mass = {};  ///< M [kg]
  /// F_M [N]; its deviation is the STD over the pushes, so half the critical band [paper C, eq.
  /// 10].
  std::optional<ParameterValue> limiting_static_friction = {};
  std::optional<ParameterValue> sliding_friction_coefficient = {};  ///< mu: Coulomb force over M g
  std::optional<ParameterValue> viscous_friction = {};              ///< B [N s/m]
  // F = stiffness d^n + damping d^n d' (n = 1: damping d').
  std::optional<ParameterValue> contact_stiffness = {};  ///< [N/m^n]
  std::optional<ParameterValue> contact_damping = {};    ///< [N s/m^(n+1)]
  std::optional<ParameterValue> contact_exponent = {};   ///< n
  /// The largest moment that the support bears over the largest force [m]; see mean_radius.
  std::optional<ParameterValue> friction_radius = {};
  std::optional<ParameterValue> tool_friction_coefficient = {};  ///< between tip and object
  std::optional<ParameterValue> loading_rate = {};  ///< [N/s] at which F_M was measured
  /// Where pushes turned the object enough. Axes: planar axes of the object, see heading_of.
  std::optional<LimitSurface> limit_surface = {};
};

/// The contact law that is known, if it is. A stiffness without its exponent is meant in N/m.
[[nodiscard]] std::optional<Compliance> compliance_of(const ObjectParameters& known);

/// By the object's name.
using ParameterTable = std::map<std::string, ObjectParameters>;

}  // namespace pcavr
