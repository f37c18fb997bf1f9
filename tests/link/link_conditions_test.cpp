// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/link/link_conditions.hpp"

#include <optional>

#include <gtest/gtest.h>

#include "pcavr/base/core/check.hpp"

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

TEST(LinkConditions, LosesInBurstsOfTheGivenMeanLength) {
  LinkConditions link({.delay = 0.1, .loss = 0.2, .burst = 8.0}, Random(5));
  int lost = 0;
  int bursts = 0;
  bool was_lost = false;
  for (int i = 0; i < 200'000; ++i) {
    const bool is_lost = !link.arrival(0.001 * i);
    lost += is_lost ? 1 : 0;
    bursts += is_lost && !was_lost ? 1 : 0;
    was_lost = is_lost;
  }
  EXPECT_NEAR(lost, 40'000, 3000);
  EXPECT_NEAR(static_cast<double>(lost) / bursts, 8.0, 0.6);
}

TEST(LinkConditions, LetsMessagesBeOvertakenAndArriveTwice) {
  LinkConditions link({.delay = 0.1, .reorder = 0.1, .duplicate = 0.2}, Random(5));
  int overtaken = 0;
  int doubled = 0;
  for (int i = 0; i < 5000; ++i) {
    const LinkConditions::Arrivals arrivals = link.arrivals(0.001 * i);
    overtaken += *arrivals.first > 0.001 * i + 0.11 ? 1 : 0;
    doubled += arrivals.second ? 1 : 0;
  }
  EXPECT_NEAR(overtaken, 500, 70);
  EXPECT_NEAR(doubled, 1000, 90);
}

TEST(LinkConditions, PassesTheBottlenecksRateAndDropsBeyondItsQueue) {
  LinkConditions link({.delay = 0.1, .rate_limit = 1000.0}, Random(5));
  int arrived = 0;
  for (int i = 0; i < 1000; ++i) arrived += link.arrival(0.01 * i, 100) ? 1 : 0;  // 10 kB/s
  EXPECT_NEAR(arrived, 105, 3);  // 10 s at 1 kB/s, and half a second's queue
}

// Conditions that are not asked for draw no random numbers of those that are.
TEST(LinkConditions, DoNotDisturbEachOther) {
  LinkConditions plain({.delay = 0.1, .jitter = 0.02}, Random(7));
  LinkConditions doubled({.delay = 0.1, .jitter = 0.02, .duplicate = 0.5}, Random(7));
  for (int i = 0; i < 100; ++i) EXPECT_EQ(plain.arrival(0.01 * i), doubled.arrival(0.01 * i));
}

TEST(DelayedMessages, ReleasesInOrderOfArrival) {
  DelayedMessages<int> messages(3);
  messages.push(0.3, 3);
  messages.push(0.1, 1);
  messages.push(0.2, 2);
  EXPECT_EQ(messages.pop(0.05), std::nullopt);
  EXPECT_EQ(messages.pop(0.25), 1);
  EXPECT_EQ(messages.pop(0.25), 2);
  EXPECT_EQ(messages.pop(0.25), std::nullopt);
  EXPECT_DOUBLE_EQ(*messages.next_arrival(), 0.3);
  for (int i = 0; i < 10; ++i) messages.push(1.0, i);
  EXPECT_EQ(messages.size(), 3U);
}

TEST(LinkConditions, RejectsNumbersOutOfRange) {
  EXPECT_THROW(LinkConditions({.delay = -0.1}, Random(1)), ContractError);
  EXPECT_THROW(LinkConditions({.loss = 1.5}, Random(1)), ContractError);
}

}  // namespace
}  // namespace pcavr
