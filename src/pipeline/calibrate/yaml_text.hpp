// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "pcavr/base/core/decimal.hpp"

namespace pcavr {

/// A text in YAML's double quotes.
inline std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result + '"';
}

/// "1, 2.5, 3"
template <typename Values>
std::string decimals(const Values& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ", ") + shortest_decimal(value);
  return text;
}

/// "[1, 2.5, 3]"
template <typename Values>
std::string number_list(const Values& values) {
  return '[' + decimals(values) + ']';
}

}  // namespace pcavr
