// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/check.hpp"

#include <sstream>

namespace pcavr::detail {

std::string value_text(int value) { return std::to_string(value); }
std::string value_text(unsigned value) { return std::to_string(value); }
std::string value_text(long value) { return std::to_string(value); }
std::string value_text(unsigned long value) { return std::to_string(value); }
std::string value_text(const std::string& value) { return value; }

std::string value_text(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

void throw_contract_error(const char* expression, const char* function,
                          std::initializer_list<std::string> values) {
  std::string text = std::string(function) + ": requires " + expression;
  for (const std::string& value : values) text += ' ' + value;
  throw ContractError(text);
}

}  // namespace pcavr::detail
