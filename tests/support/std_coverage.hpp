// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>

#include <gtest/gtest.h>

namespace pcavr {

/// Expects of errors over their stds that 68 +- `tolerance` % are within one, and none beyond 5;
/// prints both figures.
inline void expect_stds_cover(std::span<const double> ratios, double tolerance) {
  const auto within =
      std::count_if(ratios.begin(), ratios.end(), [](double z) { return std::abs(z) < 1.0; });
  double largest = 0.0;
  for (const double ratio : ratios) largest = std::max(largest, std::abs(ratio));
  const double share = 100.0 * static_cast<double>(within) / static_cast<double>(ratios.size());
  std::printf("  within one std: %.1f %%, largest error %.2f std\n", share, largest);
  EXPECT_NEAR(share, 68.0, tolerance);
  EXPECT_LT(largest, 5.0);
}

}  // namespace pcavr
