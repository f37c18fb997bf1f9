// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/friction/stribeck.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

constexpr double kStribeckSpeed = 0.003;  // [m/s]

// The exponential form, in comparison, has 5 % left at three times the speed.
TEST(StribeckShare, FallsAsAGaussian) {
  EXPECT_EQ(stribeck_share(0.0, kStribeckSpeed), 1.0);
  EXPECT_NEAR(stribeck_share(kStribeckSpeed, kStribeckSpeed), std::exp(-1.0), 1e-15);
  EXPECT_LT(stribeck_share(3.0 * kStribeckSpeed, kStribeckSpeed), 2e-4);
}

TEST(StribeckShare, IsTheSameInBothDirections) {
  EXPECT_EQ(stribeck_share(-0.002, kStribeckSpeed), stribeck_share(0.002, kStribeckSpeed));
}

}  // namespace
}  // namespace pcavr
