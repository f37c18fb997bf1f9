// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/devices/rate_tip.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

constexpr double kCycle = 0.001;  // [s]
const Eigen::Vector3d kTool(0.5, 0.1, 0.2);
const RateCommand kAway{Eigen::Vector3d::UnitX(), true, true};

TEST(RateTip, StartsAtTheTool) {
  RateTip tip({});
  EXPECT_EQ(tip.step(kAway, kCycle, kTool).p_base_tip, kTool);
  EXPECT_TRUE(tip.step(kAway, kCycle, kTool).is_engaged);
}

TEST(RateTip, LimitsItsLeadOverABlockedTool) {
  RateTip tip({});
  DeviceSample sample;
  for (int i = 0; i < 1000; ++i) sample = tip.step(kAway, kCycle, kTool);
  EXPECT_NEAR((sample.p_base_tip - kTool).norm(), 0.02, 1e-12);
  // The tip returns without delay (anti-windup).
  const DeviceSample back = tip.step({-Eigen::Vector3d::UnitX(), true, true}, kCycle, kTool);
  EXPECT_NEAR(back.p_base_tip.x(), sample.p_base_tip.x() - 0.15 * kCycle, 1e-12);
}

TEST(RateTip, IsNotPulledByAToolThatMovesElsewhere) {
  RateTip tip({});
  (void)tip.step(kAway, kCycle, kTool);
  const Eigen::Vector3d elsewhere(5.0, 0.0, 0.0);
  const RateCommand at_rest{Eigen::Vector3d::Zero(), true, true};
  EXPECT_LT((tip.step(at_rest, kCycle, elsewhere).p_base_tip - kTool).norm(), 1e-12);
}

TEST(RateTip, StaysWithTheToolWhileTheClutchIsOpen) {
  RateTip tip({});
  (void)tip.step(kAway, kCycle, kTool);
  const DeviceSample sample =
      tip.step({Eigen::Vector3d::UnitX(), false, true}, kCycle, 2.0 * kTool);
  EXPECT_EQ(sample.p_base_tip, 2.0 * kTool);
  EXPECT_FALSE(sample.is_engaged);
  EXPECT_TRUE(sample.is_present);
}

TEST(RateTip, DoesNotEngageAtAnInvalidToolPosition) {
  RateTip tip({});
  const Eigen::Vector3d nowhere =
      Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  const DeviceSample sample = tip.step(kAway, kCycle, nowhere);
  EXPECT_FALSE(sample.is_engaged);
  EXPECT_TRUE(sample.p_base_tip.allFinite());
}

}  // namespace
}  // namespace pcavr
