// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pcavr/identification/object_parameters.hpp"

namespace pcavr {

/// One number that was identified, beside the true one.
struct ParameterError {
  std::string object;
  std::string name;  ///< as in the files; "contact.stiffness"
  std::string unit;
  std::optional<ParameterValue> estimate = {};
  std::optional<double> truth = {};
  /// Of the estimate from the truth. Empty where either is not known, or where stiffness or damping
  /// belong to different exponents: then their units differ, too.
  std::optional<double> relative = {};    ///< (estimate - truth) / truth
  std::optional<double> deviations = {};  ///< (estimate - truth) in standard deviations
};

/// Every parameter that either side knows, of the objects that the estimate names; objects by name,
/// parameters in the order of the files. Where both contact laws are known, the last line of an
/// object, "contact.force", compares their elastic forces at the depth at which the true contact
/// bears the true limiting friction, so that laws of different exponents can be compared. An empty
/// `truth` gives the estimate alone.
[[nodiscard]] std::vector<ParameterError> parameter_errors(const ParameterTable& truth,
                                                           const ParameterTable& estimate);

}  // namespace pcavr
