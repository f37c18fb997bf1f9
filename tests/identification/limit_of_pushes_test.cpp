// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/identification/limit_of_pushes.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/core/random.hpp"
#include "pcavr/identification/inertial_peak.hpp"

namespace pcavr {
namespace {

TEST(CombineLimits, OnePushIsNoMoreCertainThanTheScatterBetweenPushes) {
  const std::vector<IdentifiedParameter> one{{10.0, 0.01, true}};
  const LimitOfPushes found = combine_limits(one, 0.02, 2.0);
  EXPECT_NEAR(found.limit.value, 10.0, 1e-6);
  EXPECT_GT(found.limit.std, 0.15);
}

TEST(CombineLimits, WeighsAWidePushLittleAndReportsTheScatter) {
  const std::vector<IdentifiedParameter> pushes{{10.0, 0.05, true},
                                                {10.4, 0.05, true},
                                                {9.7, 0.05, true},
                                                {20.0, 8.0, true},
                                                {5.0, 0.1, false}};
  const LimitOfPushes found = combine_limits(pushes, 0.02, 2.0);
  EXPECT_NEAR(found.limit.value, 10.03, 0.1);
  EXPECT_GT(found.scatter, 0.2);
  EXPECT_LT(found.scatter, 0.6);
  EXPECT_GT(found.limit.std, 0.1);
}

TEST(CombineLimits, HasNoValueWithoutPushes) {
  EXPECT_FALSE(combine_limits({}, 0.02, 2.0).limit.is_excited);
}

TEST(LimitAboveSliding, LeavesALimitFarAboveSlidingFriction) {
  const IdentifiedParameter limit{10.0, 0.1, true};
  const IdentifiedParameter found = limit_above_sliding(limit, {8.0, 0.1, true});
  EXPECT_NEAR(found.value, limit.value, 1e-9);
  EXPECT_NEAR(found.std, limit.std, 1e-9);
  EXPECT_TRUE(found.is_excited);
}

TEST(LimitAboveSliding, HasTheMomentsOfSamplesAboveSlidingFriction) {
  const IdentifiedParameter limit{3.0, 0.5, true}, coulomb{3.2, 0.3, true};
  Random random(5);
  double sum = 0.0, squares = 0.0, count = 0.0;
  for (int i = 0; i < 400000; ++i) {
    const double value = limit.value + limit.std * random.normal();
    if (value < coulomb.value + coulomb.std * random.normal()) continue;
    sum += value, squares += value * value, count += 1.0;
  }
  const double mean = sum / count;
  const IdentifiedParameter found = limit_above_sliding(limit, coulomb);
  EXPECT_NEAR(found.value, mean, 0.005);
  EXPECT_NEAR(found.std, std::sqrt(squares / count - mean * mean), 0.005);
}

TEST(LimitAboveSliding, IsNotExcitedWhereTheTwoContradictEachOther) {
  EXPECT_FALSE(limit_above_sliding({9.0, 0.2, true}, {10.0, 0.2, true}).is_excited);
  EXPECT_TRUE(limit_above_sliding({9.5, 0.2, true}, {10.0, 0.2, true}).is_excited);
  // A sliding friction that is not known bounds nothing.
  EXPECT_EQ(limit_above_sliding({9.0, 0.2, true}, {10.0, 0.2, false}).value, 9.0);
}

TEST(LimitOfPushes, APeakUnderFastLoadingFarAboveTheSlidingFrictionIsInertia) {
  Breakaway peak;
  peak.force = 7.0;
  peak.loading_rate = 226.0;
  const IdentifiedParameter sliding{2.6, 0.3, true};
  EXPECT_TRUE(is_inertial_peak(peak, sliding));
  peak.loading_rate = 30.0;  // a slow peak is a limit, however high
  EXPECT_FALSE(is_inertial_peak(peak, sliding));
  peak.loading_rate = 226.0;
  EXPECT_FALSE(is_inertial_peak(peak, {5.5, 0.3, true}));
  EXPECT_FALSE(is_inertial_peak(peak, {}));
}

TEST(TurningLimit, IsAsUncertainAsItsExcessUnderALargeLever) {
  EXPECT_EQ(turning_limit_std(0.0, 0.2), 0.0);
  EXPECT_EQ(turning_limit_std(-1.0, 0.2), 0.0);
  EXPECT_LT(turning_limit_std(2.0, 0.04), 0.06);
  EXPECT_GT(turning_limit_std(2.0, -0.15), 1.0);
  EXPECT_LE(turning_limit_std(2.0, 5.0), 2.0);
  EXPECT_GT(turning_limit_std(2.0, 0.09), turning_limit_std(2.0, 0.07));
}

TEST(TurningLimit, ItsShareAndLeverAreOptions) {
  BreakawayPriors priors;
  priors.turning_share = 0.5;
  priors.turning_lever = 0.2;
  EXPECT_DOUBLE_EQ(turning_limit_std(2.0, 0.2, priors), 1.0);
  EXPECT_LT(turning_limit_std(2.0, 0.1, priors), 0.1);
}

}  // namespace
}  // namespace pcavr
