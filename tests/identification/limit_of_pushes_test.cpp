// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/identification/limit_of_pushes.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/core/median.hpp"
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

TEST(LimitOfTurning, IsTheMedianOfWhatDrawnPeaksMayHide) {
  const BreakawayPriors priors;
  const IdentifiedParameter limit{10.6, 0.02, true}, coulomb{10.0, 0.01, true};
  const double share = 0.8;
  Random random(3);
  std::vector<double> limits;
  for (int i = 0; i < 2000000; ++i) {
    const double friction = coulomb.value + coulomb.std * random.normal();
    const double excess =
        priors.excess * friction * std::pow(priors.excess_factor, random.normal());
    const double shown = friction + excess * (1.0 - random.uniform(0.0, share));
    if (std::abs(shown + limit.std * random.normal() - limit.value) > 0.01) continue;
    limits.push_back(friction + excess);
  }
  const double middle = median(limits);
  double squares = 0.0;
  for (const double one : limits) squares += std::pow(one - middle, 2);
  const IdentifiedParameter found =
      limit_of_turning(limit, coulomb, share * priors.turning_onset, priors);
  EXPECT_NEAR(found.value, middle, 0.02);
  EXPECT_NEAR(found.std, std::sqrt(squares / static_cast<double>(limits.size())), 0.03);
}

// What may be hidden is above the peak only: a std that counted it on both sides, cut off below
// Coulomb friction, raised a limit that hardly exceeds it by as much as the prior is wide.
TEST(LimitOfTurning, RaisesASmallExcessByLessThanThePriorsMedian) {
  const IdentifiedParameter limit{10.4, 0.05, true}, coulomb{10.0, 0.05, true};
  const IdentifiedParameter found = limit_of_turning(limit, coulomb, 0.2);
  EXPECT_GT(found.value, 10.6);
  EXPECT_LT(found.value, 11.4);
  EXPECT_GT(found.std, 0.5 * (found.value - limit.value));
}

TEST(LimitOfTurning, IsThePeakWhereTheObjectHardlyTurns) {
  const IdentifiedParameter limit{12.0, 0.05, true}, coulomb{10.0, 0.05, true};
  const IdentifiedParameter found = limit_of_turning(limit, coulomb, 1e-6);
  EXPECT_NEAR(found.value, limit.value, 0.03);
  EXPECT_NEAR(found.std, limit.std, 0.02);
  EXPECT_LT(limit_of_turning(limit, coulomb, 0.01).value, 12.3);
  // However uncertain: the prior's median of 12 N is no observation.
  EXPECT_NEAR(limit_of_turning({14.0, 0.9, true}, coulomb, 1e-6).value, 14.0, 0.05);
}

TEST(LimitOfTurning, IsNotExcitedFarBelowSlidingFriction) {
  EXPECT_FALSE(limit_of_turning({9.0, 0.1, true}, {10.0, 0.1, true}, 0.1).is_excited);
  EXPECT_FALSE(limit_of_turning({9.0, 0.1, true}, {0.0, 0.1, true}, 0.1).is_excited);
}

}  // namespace
}  // namespace pcavr
