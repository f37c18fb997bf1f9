// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace pcavr {

/// With `decimals` places; independent of the locale.
[[nodiscard]] std::string fixed(double value, int decimals);

/// With three significant digits and at most four decimals, never as a power of ten: 0.0123, 1.23,
/// 123, 12345.
[[nodiscard]] std::string readable(double value);

}  // namespace pcavr
