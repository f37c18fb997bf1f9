// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/identification/limit_of_pushes.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/physics/identification/inertial_peak.hpp"

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

TEST(HiddenByTurning, IsNothingWhereTheObjectDoesNotTurn) {
  EXPECT_EQ(excess_hidden_by_turning(2.0, 10.0, 0.0).value, 0.0);
  EXPECT_EQ(excess_hidden_by_turning(2.0, 10.0, 0.0).std, 0.0);
  EXPECT_EQ(excess_hidden_by_turning(0.0, 10.0, 0.2).std, 0.0);
  EXPECT_LT(excess_hidden_by_turning(2.0, 10.0, 0.01).value, 0.3);
  EXPECT_GT(excess_hidden_by_turning(2.0, 10.0, 0.06).std,
            excess_hidden_by_turning(2.0, 10.0, 0.04).std);
}

TEST(HiddenByTurning, ASmallExcessSaysLittleWhereTurningMayHideAllOfIt) {
  BreakawayPriors priors;
  // The excess's own size does not bound what is hidden: the prior's median is 2 N.
  const IdentifiedParameter hidden = excess_hidden_by_turning(0.2, 10.0, 0.2);
  EXPECT_GT(hidden.value, 0.4);
  EXPECT_GT(hidden.std, 0.4);
  priors.turning_onset = 0.4;
  EXPECT_LT(excess_hidden_by_turning(0.2, 10.0, 0.2, priors).std, 0.1);
}

TEST(HiddenByTurning, IsWhatDrawnPeaksLack) {
  const BreakawayPriors priors;
  const double coulomb = 10.0, excess = 1.0, share = 0.6;
  Random random(3);
  double count = 0.0, sum = 0.0, squares = 0.0;
  for (int i = 0; i < 1000000; ++i) {
    const double true_excess =
        priors.excess * coulomb * std::pow(priors.excess_factor, random.normal());
    const double seen = true_excess * (1.0 - random.uniform(0.0, share));
    if (std::abs(seen - excess) > 0.02) continue;
    count += 1.0;
    sum += true_excess - seen;
    squares += std::pow(true_excess - seen, 2);
  }
  const double mean = sum / count;
  const IdentifiedParameter hidden =
      excess_hidden_by_turning(excess, coulomb, share * priors.turning_onset, priors);
  EXPECT_NEAR(hidden.value, mean, 0.02);
  EXPECT_NEAR(hidden.std, std::sqrt(squares / count - mean * mean), 0.02);
}

}  // namespace
}  // namespace pcavr
