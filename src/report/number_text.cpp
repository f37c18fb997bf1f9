// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/report/number_text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace pcavr {

std::string fixed(double value, int decimals) {
  std::array<char, 400> buffer{};  // the largest double has 309 digits before the point
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                 std::chars_format::fixed, decimals);
  std::string text(buffer.data(), end.ptr);
  if (std::all_of(text.begin(), text.end(),
                  [](char c) { return c == '-' || c == '0' || c == '.'; })) {
    text.erase(0, text.front() == '-' ? 1 : 0);  // no "-0.00"
  }
  return text;
}

std::string readable(double value) {
  if (!std::isfinite(value)) return "-";
  // A ten-thousandth of any unit used here is below the measurement accuracy.
  if (std::abs(value) < 0.5e-4) return "0";
  const int digits_before_point = static_cast<int>(std::floor(std::log10(std::abs(value)))) + 1;
  return fixed(value, std::clamp(3 - digits_before_point, 0, 4));
}

}  // namespace pcavr
