// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/link/link_clock.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

namespace pcavr {
namespace {

/// Two clocks and a network between them; `t` is this site's clock.
struct ClockPair {
  double offset = 0.0;
  double drift = 0.0;
  double forward = 0.2;
  double backward = 0.2;
  double jitter = 0.0;  ///< [s] mean of exponentially distributed queueing, in each direction
  Random random{1};

  [[nodiscard]] double shared(double t) const { return offset + (1.0 + drift) * t; }
  [[nodiscard]] double queueing() { return -jitter * std::log(1.0 - random.uniform()); }
  LinkClock::RoundTrip round_trip(double t) {
    const double received = t + forward + queueing();
    const double replied = received + 1e-4;
    const double returned = replied + backward + queueing();
    return {t, shared(received), shared(replied), returned};
  }
};

TEST(LinkClock, FindsOffsetAndDriftThroughJitter) {
  ClockPair clocks{.offset = 86'400.0, .drift = 4e-5, .jitter = 0.01};
  LinkClock clock;
  for (int i = 0; i < 600; ++i) clock.add(clocks.round_trip(0.1 * i));
  EXPECT_NEAR(clock.shared_at(60.0), clocks.shared(60.0), 5e-4);
  EXPECT_NEAR(clock.drift(), 4e-5, 2e-5);
  EXPECT_NEAR(clock.local_at(clock.shared_at(61.0)), 61.0, 1e-6);
  EXPECT_EQ(clock.steps(), 0);
}

// The stated uncertainty holds for any asymmetry, jitter and drift.
TEST(LinkClock, StatesAnUncertaintyThatCoversItsError) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Random random(seed);
    ClockPair clocks{.offset = random.uniform(-1e5, 1e5),
                     .drift = random.uniform(-8e-5, 8e-5),
                     .forward = random.uniform(0.0, 0.3),
                     .backward = random.uniform(0.0, 0.3),
                     .jitter = random.uniform(0.0, 0.03),
                     .random = random.fork(1)};
    LinkClock clock;
    for (int i = 0; i < 200; ++i) {
      const double t = 0.1 * i;
      clock.add(clocks.round_trip(t));
      const double error = std::abs(clock.shared_at(t) - clocks.shared(t));
      EXPECT_LE(error, clock.max_asymmetry() + 4.0 * clock.std() + 1e-4) << seed << ", " << t;
    }
  }
}

TEST(LinkClock, FollowsAStepOfTheOtherClock) {
  ClockPair clocks{.offset = 5.0, .jitter = 0.005};
  LinkClock clock;
  for (int i = 0; i < 100; ++i) clock.add(clocks.round_trip(0.1 * i));
  clocks.offset = -3600.0;
  for (int i = 100; i < 110; ++i) clock.add(clocks.round_trip(0.1 * i));
  EXPECT_EQ(clock.steps(), 1);
  EXPECT_NEAR(clock.shared_at(11.0), clocks.shared(11.0), 0.01);
}

// A site that did not run, or a network that stalled, delivers many late answers at once: neither
// the offset nor the usual delay follows them.
TEST(LinkClock, RefusesRoundTripsThatWereStalled) {
  ClockPair clocks{.offset = 5.0, .forward = 0.02, .backward = 0.02};
  LinkClock clock;
  for (int i = 0; i < 100; ++i) clock.add(clocks.round_trip(0.1 * i));
  for (int i = 0; i < 50; ++i) {
    const double sent = 10.0 + 0.01 * i;  // all answers arrive at 10.5, one of them hardly late
    clock.add({sent, clocks.shared(sent + 0.02), clocks.shared(sent + 0.0201), 10.54});
  }
  EXPECT_LT(clock.mean_delay(), 0.14);  // those that were less than 0.1 s late count
  EXPECT_LT(clock.delay_variation(), 0.05);
  EXPECT_NEAR(clock.shared_at(10.6), clocks.shared(10.6), 1e-3);
  EXPECT_EQ(clock.steps(), 0);
}

// ... also if they are the first ones.
TEST(LinkClock, ForgetsStalledRoundTripsOnceThereAreFasterOnes) {
  ClockPair clocks{.offset = 5.0, .forward = 0.02, .backward = 0.02};
  LinkClock clock;
  for (int i = 0; i < 20; ++i) {
    const double sent = 0.01 * i;
    clock.add({sent, clocks.shared(sent + 0.02), clocks.shared(sent + 0.0201), 5.0});
  }
  for (int i = 0; i < 3; ++i) clock.add(clocks.round_trip(5.01 + 0.01 * i));
  EXPECT_NEAR(clock.mean_delay(), 0.04, 0.005);
  EXPECT_LT(clock.delay_variation(), 0.03);
}

TEST(LinkClock, FollowsANetworkThatHasBecomeSlower) {
  ClockPair clocks{.offset = 5.0, .forward = 0.02, .backward = 0.02};
  LinkClock clock;
  for (int i = 0; i < 50; ++i) clock.add(clocks.round_trip(0.1 * i));
  clocks.forward = clocks.backward = 0.2;
  for (int i = 50; i < 100; ++i) clock.add(clocks.round_trip(0.1 * i));
  EXPECT_NEAR(clock.mean_delay(), 0.4, 0.05);
}

// A single wrong answer, and impossible ones, change nothing.
TEST(LinkClock, IgnoresImplausibleRoundTrips) {
  ClockPair clocks{.offset = 5.0};
  LinkClock clock;
  for (int i = 0; i < 100; ++i) clock.add(clocks.round_trip(0.1 * i));
  const double before = clock.shared_at(10.0);
  clock.add({10.0, 99.0, 99.0, 10.4});
  clock.add({10.0, 20.0, 15.0, 10.4});
  clock.add({10.0, 5.0, 30.0, 10.4});
  clock.add({10.0, std::nan(""), 5.0, 10.4});
  EXPECT_DOUBLE_EQ(clock.shared_at(10.0), before);
  EXPECT_EQ(clock.steps(), 0);
}

}  // namespace
}  // namespace pcavr
