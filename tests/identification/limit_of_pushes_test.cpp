// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/identification/limit_of_pushes.hpp"

#include <vector>

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace pcavr
