// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/link/link_conditions.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "pcavr/core/check.hpp"

namespace pcavr {
namespace {

TEST(LinkConditions, DelaysByItsDelay) {
  LinkConditions link({.delay = 0.2}, Random(1));
  EXPECT_DOUBLE_EQ(*link.arrival(1.0), 1.2);
  EXPECT_DOUBLE_EQ(*link.arrival(1.5), 1.7);
}

TEST(LinkConditions, KeepsTheOrderUnderJitter) {
  LinkConditions link({.delay = 0.05, .jitter = 0.05}, Random(3));
  double before = 0.0;
  bool is_ever_delayed = false;
  for (int i = 0; i < 500; ++i) {
    const double sent = 0.01 * i;
    const double arrival = *link.arrival(sent);
    EXPECT_GE(arrival, before);
    EXPECT_GE(arrival, sent);
    is_ever_delayed = is_ever_delayed || arrival > sent + 0.06;
    before = arrival;
  }
  EXPECT_TRUE(is_ever_delayed);
}

TEST(LinkConditions, LosesTheGivenRatio) {
  LinkConditions link({.delay = 0.1, .loss = 0.3}, Random(5));
  int lost = 0;
  for (int i = 0; i < 2000; ++i) lost += link.arrival(0.01 * i) ? 0 : 1;
  EXPECT_NEAR(lost, 600, 65);  // three standard deviations of the binomial
}

TEST(LinkConditions, IsDeterministicForTheSameSeed) {
  LinkConditions one({.delay = 0.1, .jitter = 0.02, .loss = 0.2}, Random(7));
  LinkConditions two({.delay = 0.1, .jitter = 0.02, .loss = 0.2}, Random(7));
  for (int i = 0; i < 100; ++i) EXPECT_EQ(one.arrival(0.01 * i), two.arrival(0.01 * i));
}

TEST(LinkConditions, RejectsNumbersOutOfRange) {
  EXPECT_THROW(LinkConditions({.delay = -0.1}, Random(1)), ContractError);
  EXPECT_THROW(LinkConditions({.loss = 1.5}, Random(1)), ContractError);
}

}  // namespace
}  // namespace pcavr
