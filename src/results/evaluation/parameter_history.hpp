// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "report.hpp"

namespace pcavr {

/// An arrival of parameters at the operator's site, and the rendered force's error in contact
/// before and after it: until the next arrival, or the end.
struct ParameterArrival {
  Stamp stamp;
  std::vector<std::string> parameters;         ///< that changed there
  std::optional<double> force_error_before{};  ///< relative: mean error over mean force
  std::optional<double> force_error_after{};
};
/// `forces` are those of the same object, ascending.
[[nodiscard]] std::vector<ParameterArrival> parameter_arrivals(
    const ParameterSamples& history, const std::vector<ForceSample>& forces);

/// Paper C's figure 9 of one object: transmitted against running parameters, and the force error
/// after each arrival. Without tables where no parameter ever changed.
[[nodiscard]] ReportSection parameter_history_section(const std::string& object,
                                                      const Findings& findings);

}  // namespace pcavr
