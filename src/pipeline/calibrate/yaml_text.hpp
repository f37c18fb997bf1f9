// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <Eigen/Core>

namespace pcavr {

// Values of the calibration files.

/// Marks a calibration in another program's format, so that it may be replaced.
inline constexpr char kForeignCalibration[] = "# written by pcavr calibrate";

/// A text in YAML's double quotes.
[[nodiscard]] std::string quoted(const std::string& text);

/// "[1, 2.5]"
[[nodiscard]] std::string number_list(const Eigen::VectorXd& values);

/// The rows of a matrix as a list each, indented by `indent` and "- ".
[[nodiscard]] std::string row_lists(const Eigen::MatrixXd& matrix, const std::string& indent);

}  // namespace pcavr
