// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pcavr/physics/object/object_parameters.hpp"

namespace pcavr {

/// One identified parameter and its true value.
struct ParameterError {
  std::string object;
  std::string name;  ///< as in the files; "contact.stiffness"
  std::string unit;
  std::optional<ParameterValue> estimate = {};
  std::optional<double> truth = {};
  bool is_given = false;  ///< the estimate was stated, not identified: its error is no result
  /// Of the estimate from the truth. Empty where either is unknown, or where stiffness or damping
  /// belong to different exponents: then their units differ, too.
  std::optional<double> relative = {};      ///< (estimate - truth) / truth
  std::optional<double> error_in_std = {};  ///< (estimate - truth) / std
};

/// Every parameter of either side, of the objects in the estimate; objects by name, parameters in
/// the order of the files. Where both contact laws are known, the last line of an object,
/// "contact.force", compares their elastic forces at the penetration at which the true contact's
/// force equals the true limiting friction, so that laws of different exponents can be compared. A
/// restitution's truth is that of the true law at the speed of the measured impacts. An
/// empty `truth` gives the estimate alone.
[[nodiscard]] std::vector<ParameterError> parameter_errors(const ParameterTable& truth,
                                                           const ParameterTable& estimate);

}  // namespace pcavr
