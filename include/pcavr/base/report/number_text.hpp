// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace pcavr {

/// The number with `decimals` places, independent of the locale.
[[nodiscard]] std::string fixed(double value, int decimals);

/// The number with three significant digits and at most four decimals, never as a power of ten:
/// 0.0123, 1.23, 123, 12345.
[[nodiscard]] std::string readable(double value);

/// A value and its standard deviation, as text; "-": not known.
struct UncertainText {
  std::string value = "-";
  std::string std = "-";
};

/// Both with as many decimals as the standard deviation has in two significant digits; below a
/// thousandth, from a hundred thousand on, and where the deviation is a thousand or more, as
/// multiples of one power of ten: 3.13 and 0.21,
/// 2.77e+05 and 0.86e+05.
[[nodiscard]] UncertainText uncertain(double value, const std::optional<double>& std);

}  // namespace pcavr
