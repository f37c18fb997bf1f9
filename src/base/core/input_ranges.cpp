// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/input_ranges.hpp"

#include <charconv>

namespace pcavr {
namespace {

std::string decimal(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

/// The unit with a space before it; empty for a quantity without a unit.
std::string unit_of(const InputRange& range) {
  const std::string unit = range.unit;
  return unit == "1" || unit == "any" ? "" : ' ' + unit;
}

}  // namespace

std::optional<Error> check_range(const InputRange& range, double value,
                                 const std::string& written) {
  if (range.contains(value)) return std::nullopt;
  return Error{.message = written + " is out of range for a " + range.quantity,
               .hint = "write a number from " + decimal(range.min) + " to " + decimal(range.max) +
                       unit_of(range)};
}

std::optional<Error> check_range(const InputRange& range, double value) {
  return check_range(range, value, decimal(value));
}

}  // namespace pcavr
