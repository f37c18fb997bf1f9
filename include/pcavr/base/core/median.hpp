// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace pcavr {

/// The median: the middle value, the upper of two; 0 for an empty list.
[[nodiscard]] inline double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// A normal distribution's standard deviation over its median absolute deviation (MAD).
inline constexpr double kStdOverMad = 1.4826;

}  // namespace pcavr
