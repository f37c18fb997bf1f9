// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "yaml_text.hpp"

#include "pcavr/base/core/decimal.hpp"

namespace pcavr {

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result + '"';
}

std::string number_list(const Eigen::VectorXd& values) {
  std::string text = "[";
  for (const double value : values) text += (text.size() > 1 ? ", " : "") + shortest_decimal(value);
  return text + ']';
}

std::string row_lists(const Eigen::MatrixXd& matrix, const std::string& indent) {
  std::string text;
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    text += indent + "- " + number_list(matrix.row(row).transpose()) + '\n';
  }
  return text;
}

}  // namespace pcavr
