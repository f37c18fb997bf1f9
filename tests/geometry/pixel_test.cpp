// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/geometry/pixel.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(PixelIndex, IsThePixelThatContainsThePosition) {
  EXPECT_EQ(pixel_index(-0.5, 4), 0);
  EXPECT_EQ(pixel_index(0.49, 4), 0);
  EXPECT_EQ(pixel_index(0.5, 4), 1);
  EXPECT_EQ(pixel_index(3.49, 4), 3);
}

TEST(PixelIndex, IsNothingOutsideTheImage) {
  for (const double outside : {-0.51, 3.5, 1e10, -1e10, 1e300, HUGE_VAL, -HUGE_VAL, kNan}) {
    EXPECT_EQ(pixel_index(outside, 4), std::nullopt) << outside;
  }
  EXPECT_EQ(pixel_index(0.0, 0), std::nullopt);
}

TEST(ClampToInt, ClampsToItsBounds) {
  EXPECT_EQ(clamp_to_int(2.7, 0, 5), 2);
  EXPECT_EQ(clamp_to_int(-2.7, -5, 5), -2);
  EXPECT_EQ(clamp_to_int(5.0, 0, 5), 5);
  EXPECT_EQ(clamp_to_int(1e300, 0, 5), 5);
  EXPECT_EQ(clamp_to_int(-HUGE_VAL, 0, 5), 0);
  EXPECT_EQ(clamp_to_int(kNan, 0, 5), 0);
}

}  // namespace
}  // namespace pcavr
