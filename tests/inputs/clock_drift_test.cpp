// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

#include "physics/inputs/clock_offsets.hpp"

namespace pcavr {
namespace {

/// Delays of contacts 1.5 s apart, with noise of their std, that grow by `rate` [s/s].
std::vector<PressDelay> delays_of(std::size_t count, double std, double rate, std::uint64_t seed) {
  Random random(seed);
  std::vector<PressDelay> delays;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = 2.0 + 1.5 * static_cast<double>(i);
    delays.push_back({t, 0.012 + rate * t + std * random.normal(), std, 0.0});
  }
  return delays;
}

TEST(ClockDrift, IsFoundInBothDirections) {
  for (const double rate : {0.002, -0.002, 0.02}) {
    const auto drift = find_drift(delays_of(7, 0.001, rate, 1));
    ASSERT_TRUE(drift) << rate;
    EXPECT_NEAR(drift->rate, rate, 4.0 * drift->rate_std);
    EXPECT_NEAR(drift->delay(0.0), 0.012, 0.004);
  }
}

TEST(ClockDrift, IsNoneOfAConstantDelay) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U, 6U, 7U, 8U}) {
    EXPECT_FALSE(find_drift(delays_of(4, 0.010, 0.0, seed))) << seed;
    EXPECT_FALSE(find_drift(delays_of(10, 0.001, 0.0, seed))) << seed;
  }
}

TEST(ClockDrift, IsFoundBesideAContactThatShowsAnotherDelay) {
  std::vector<PressDelay> delays = delays_of(7, 0.001, 0.003, 2);
  delays[3].delay = -0.4;
  const auto drift = find_drift(delays);
  ASSERT_TRUE(drift);
  EXPECT_NEAR(drift->rate, 0.003, 4.0 * drift->rate_std);
}

TEST(ClockDrift, IsNoStepOfTheClock) {
  std::vector<PressDelay> delays = delays_of(8, 0.001, 0.0, 3);
  for (std::size_t i = 4; i < delays.size(); ++i) delays[i].delay += 0.1;
  EXPECT_FALSE(find_drift(delays));
}

TEST(ClockDrift, IsNotKnownWhereBodiesMayDifferByAsMuch) {
  std::vector<PressDelay> delays = delays_of(7, 0.001, 0.003, 5);
  for (PressDelay& delay : delays) delay.bias = 0.02;
  EXPECT_FALSE(find_drift(delays));
  for (PressDelay& delay : delays) delay.bias = 0.01;
  EXPECT_TRUE(find_drift(delays));
}

TEST(ClockDrift, NeedsThreeContacts) { EXPECT_FALSE(find_drift(delays_of(2, 0.001, 0.01, 4))); }

}  // namespace
}  // namespace pcavr
