// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/report/number_text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace pcavr {
namespace {

constexpr int kMaxDecimals = 6;

/// The power of ten of the first significant digit: 0 for 1 to 10, -1 for 0.1 to 1.
int power_of_ten(double value) { return static_cast<int>(std::floor(std::log10(std::abs(value)))); }

/// The decimals of two significant digits.
int decimals_of(double std) { return std::clamp(1 - power_of_ten(std), 0, kMaxDecimals); }

/// Both numbers as multiples of the value's power of ten.
UncertainText scaled(double value, const std::optional<double>& std) {
  const int power = power_of_ten(value);
  const double unit = std::pow(10.0, power);
  const int decimals = std ? decimals_of(*std / unit) : 2;
  const std::string digits = std::to_string(std::abs(power));
  const std::string factor =
      std::string(power < 0 ? "e-" : "e+") + (digits.size() < 2 ? "0" : "") + digits;
  UncertainText text{.value = fixed(value / unit, decimals) + factor};
  if (std) text.std = fixed(*std / unit, decimals) + factor;
  return text;
}

}  // namespace

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

UncertainText uncertain(double value, const std::optional<double>& std) {
  constexpr double kSmall = 1e-3, kLarge = 1e5, kCoarse = 1e3;
  const bool has_std = std && std::isfinite(*std) && *std > 0.0;
  if (!std::isfinite(value)) return {};
  const double size = std::abs(value);
  // Digits below two of the std would say nothing: 1.50e+04 ± 0.32e+04, not 14989 ± 3208.
  const bool is_uncertain = has_std && *std >= kCoarse && size > 0.0;
  if (size >= kLarge || is_uncertain || (size > 0.0 && size < kSmall))
    return scaled(value, has_std ? std : std::nullopt);
  if (!has_std) return {.value = readable(value)};
  const int decimals = decimals_of(*std);
  return {fixed(value, decimals), fixed(*std, decimals)};
}

}  // namespace pcavr
