// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/link/correction_channel.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/teleoperation/link/link_conditions.hpp"

namespace pcavr {
namespace {

LinkConditions::Options random_conditions(Random& random) {
  return {.delay = random.uniform(0.0, 0.4),
          .jitter = random.uniform(0.0, 0.1),
          .loss = random.uniform(0.0, 0.6),
          .burst = random.uniform(0.0, 20.0),
          .reorder = random.uniform(0.0, 0.3),
          .reorder_delay = random.uniform(0.0, 0.3),
          .duplicate = random.uniform(0.0, 0.3),
          .rate_limit = random.uniform() < 0.3 ? random.uniform(2e4, 1e6) : 0.0};
}

/// Both ends in virtual time: 20 s of corrections, then until all are acknowledged, for at most ten
/// minutes (a burst may take a minute when few messages are sent). Returns what the receiver took.
std::vector<LinkCorrection> transmit(std::uint64_t seed, CorrectionSender& sender) {
  Random random(seed);
  LinkConditions forward(random_conditions(random), random.fork(1));
  LinkConditions backward(random_conditions(random), random.fork(2));
  DelayedMessages<LinkCorrection> corrections;
  DelayedMessages<LinkAcknowledgement> acknowledgements;
  CorrectionReceiver receiver;
  std::vector<LinkCorrection> taken;
  double t_corrected = 0.0;
  for (int cycle = 0; cycle < 4'000 || (sender.pending() > 0 && cycle < 120'000); ++cycle) {
    const double now = 0.005 * cycle;
    if (now < 20.0 && random.uniform() < 0.05) {
      t_corrected += random.uniform();
      sender.push({0, t_corrected, 0.0, {static_cast<std::uint8_t>(random.below(256))}});
    }
    for (const LinkCorrection& due : sender.take_due(now)) {
      const LinkConditions::Arrivals arrivals = forward.arrivals(now, 60);
      if (arrivals.first) corrections.push(*arrivals.first, due);
      if (arrivals.second) corrections.push(*arrivals.second, due);
    }
    while (auto correction = corrections.pop(now)) receiver.accept(std::move(*correction));
    for (LinkCorrection& correction : receiver.take(now)) taken.push_back(std::move(correction));
    const LinkConditions::Arrivals back = backward.arrivals(now, 40);
    if (back.first) acknowledgements.push(*back.first, receiver.acknowledgement());
    if (back.second) acknowledgements.push(*back.second, receiver.acknowledgement());
    while (const auto acknowledged = acknowledgements.pop(now)) {
      sender.acknowledge(*acknowledged, now);
    }
  }
  return taken;
}

TEST(CorrectionChannel, DeliversEachExactlyOnceAndInOrderOverAnyLink) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    CorrectionSender sender;
    const std::vector<LinkCorrection> taken = transmit(seed, sender);
    ASSERT_EQ(taken.size(), sender.last_number()) << seed;
    EXPECT_EQ(sender.pending(), 0U) << seed;
    for (std::size_t i = 0; i < taken.size(); ++i) {
      EXPECT_EQ(taken[i].number, i + 1) << seed;
      if (i > 0) {
        EXPECT_GE(taken[i].t, taken[i - 1].t);
      }
    }
  }
}

TEST(CorrectionChannel, IsReproducible) {
  CorrectionSender one;
  CorrectionSender two;
  const std::vector<LinkCorrection> first = transmit(7, one);
  EXPECT_EQ(first.size(), transmit(7, two).size());
  EXPECT_EQ(one.repetitions(), two.repetitions());
}

TEST(CorrectionChannel, SendsOnceOverALinkWithoutFaults) {
  CorrectionSender sender;
  CorrectionReceiver receiver;
  for (int i = 0; i < 100; ++i) {
    const double now = 0.1 * i;
    sender.push({0, now, 0.0, {1}});
    for (LinkCorrection& due : sender.take_due(now)) EXPECT_TRUE(receiver.accept(std::move(due)));
    sender.acknowledge(receiver.acknowledgement(), now + 0.05);
    EXPECT_EQ(receiver.take(now).size(), 1U);
  }
  EXPECT_EQ(sender.repetitions(), 0U);
  EXPECT_EQ(sender.pending(), 0U);
}

// Corrections that were not late wait for the command that they name; those after one that waits,
// too.
TEST(CorrectionChannel, SendsAMissingOneAgainWithTheNext) {
  CorrectionSender sender;
  sender.push({0, 1.0, 0.0, {1}});
  EXPECT_EQ(sender.take_due(0.0).size(), 1U);
  EXPECT_TRUE(sender.take_due(0.3).empty());
  // Later ones wait for it: two chances cost less than a timeout.
  sender.push({0, 2.0, 0.0, {2}});
  EXPECT_EQ(sender.take_due(0.3).size(), 2U);
  sender.push({0, 3.0, 0.0, {3}});
  EXPECT_EQ(sender.take_due(0.35).size(), 1U);  // within the same burst of losses: no third
}

TEST(CorrectionChannel, BacksOffOnlyAfterSeveralLosses) {
  CorrectionSender sender;
  sender.push({0, 1.0, 0.0, {1}});
  std::vector<double> sent;
  for (double now = 0.0; now < 10.0; now += 0.01) {
    if (!sender.take_due(now).empty()) sent.push_back(now);
  }
  ASSERT_GE(sent.size(), 6U);
  for (std::size_t i = 1; i < 5; ++i) EXPECT_NEAR(sent[i] - sent[i - 1], 0.5, 0.03);
  EXPECT_NEAR(sent[5] - sent[4], 1.0, 0.03);
}

TEST(CorrectionChannel, GivesThemWhenTheyAreDue) {
  CorrectionReceiver receiver;
  EXPECT_TRUE(receiver.accept({1, 1.0, 1.4, {1}}));
  EXPECT_TRUE(receiver.accept({2, 1.1, 1.3, {2}}));
  EXPECT_EQ(receiver.acknowledgement().up_to, 2U);
  EXPECT_TRUE(receiver.take(1.35).empty());
  EXPECT_EQ(receiver.take(1.4).size(), 2U);
  EXPECT_TRUE(receiver.accept({3, 1.2, 1.3, {3}}));
  EXPECT_EQ(receiver.take(1.5).size(), 1U);
}

TEST(CorrectionChannel, IgnoresAcknowledgementsOfWhatWasNotSent) {
  CorrectionSender sender;
  sender.push({0, 1.0, 0.0, {1}});
  sender.acknowledge({1, 0}, 0.0);  // queued, not sent
  sender.acknowledge({5, 0}, 0.0);
  EXPECT_EQ(sender.pending(), 1U);
}

TEST(CorrectionChannel, BoundsItsMemory) {
  CorrectionSender sender;
  while (!sender.is_full()) sender.push({});
  EXPECT_THROW(sender.push({}), ContractError);
  CorrectionReceiver receiver;
  EXPECT_FALSE(receiver.accept({4'000'000'000U, 0.0, 0.0, {1}}));
  EXPECT_TRUE(receiver.accept({2, 0.0, 0.0, {1}}));
  EXPECT_FALSE(receiver.accept({2, 0.0, 0.0, {1}}));
  EXPECT_TRUE(receiver.take(0.0).empty());
  EXPECT_EQ(receiver.acknowledgement().later, 1U);
}

}  // namespace
}  // namespace pcavr
