// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "marker/layout_coverage.hpp"

#include <cstdio>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

TEST(SolveTagLayout, StatesStdsThatHoldOn200RandomLayouts) {
  const test::LayoutCoverage coverage = test::layout_coverage(1000, 200);
  std::printf("  within one std: %.1f %%, largest error %.2f std\n", coverage.percent,
              coverage.largest);
  EXPECT_NEAR(coverage.percent, 68.0, 8.0);
  EXPECT_LT(coverage.largest, 5.0);
}

}  // namespace
}  // namespace pcavr
