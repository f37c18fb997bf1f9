// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/devices/remote_device.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "devices/jittered_hand.hpp"

namespace pcavr {
namespace {

using test::kCycle;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInterval = 1.0 / 64.0;  // [s] a whole number of bits

RemoteSample sample_at(double clock, const Eigen::Vector3d& p_base_tip, bool is_engaged,
                       std::uint32_t sender = 0) {
  return {.p_base_tip = p_base_tip,
          .is_engaged = is_engaged,
          .sender_clock = clock,
          .arrival = clock,
          .sender = sender};
}

/// A device whose page sends every 1/64 s with the clutch closed or open; a tool that follows it.
struct Session {
  RemoteDevice device;
  DeviceFeedback feedback{.p_base_tool = {0.5, 0.1, 0.2}};
  DeviceSample sample;
  double t = 0.0;
  double next = 0.0;

  /// Runs for `duration` with the hand at `tip(t)`.
  template <typename Tip>
  void run_for(double duration, bool is_engaged, const Tip& tip) {
    for (const double end = t + duration; t < end; t += kCycle) {
      for (; next <= t; next += kInterval)
        (void)device.push(sample_at(next, tip(next), is_engaged));
      sample = device.exchange(t, kCycle, feedback);
      if (sample.is_engaged) feedback.p_base_tool = sample.p_base_tip;
    }
  }
  void stay_silent(double duration) {
    for (const double end = t + duration; t < end; t += kCycle) {
      sample = device.exchange(t, kCycle, feedback);
    }
    next = t;
  }
};

Eigen::Vector3d at_rest(double) { return {1.0, 2.0, 3.0}; }
Eigen::Vector3d along_x(double t) { return {0.1 * t, 2.0, 3.0}; }

TEST(RemoteDevice, IsAbsentBeforeTheFirstSample) {
  RemoteDevice device;
  const DeviceSample sample = device.exchange(0.0, kCycle, {});
  EXPECT_FALSE(sample.is_present);
  EXPECT_FALSE(sample.is_engaged);
  EXPECT_TRUE(std::isnan(device.status().sender_clock));
  EXPECT_EQ(device.name(), "remote");
}

TEST(RemoteDevice, ClosesItsClutchAtTheTool) {
  Session session;
  session.run_for(0.2, false, at_rest);
  EXPECT_TRUE(session.sample.is_present);
  EXPECT_FALSE(session.sample.is_engaged);
  session.run_for(0.2, true, at_rest);
  EXPECT_TRUE(session.sample.is_engaged);
  EXPECT_LT((session.sample.p_base_tip - Eigen::Vector3d(0.5, 0.1, 0.2)).norm(), 1e-12);
}

TEST(RemoteDevice, MovesTheToolByTheHandsMotionWhileEngagedOnly) {
  Session session;
  session.run_for(1.0, false, along_x);
  const double from = session.next;
  session.run_for(1.0, true, along_x);
  const double engaged_until = session.device.status().shown_clock;
  const Eigen::Vector3d tool = session.feedback.p_base_tool;
  EXPECT_NEAR(tool.x(), 0.5 + 0.1 * (engaged_until - from), 1e-9);
  EXPECT_NEAR(tool.y(), 0.1, 1e-12);
  session.run_for(1.0, false, along_x);
  EXPECT_EQ(session.feedback.p_base_tool, tool);
  session.run_for(0.016, true, along_x);
  EXPECT_TRUE(session.sample.is_engaged);
  EXPECT_LT((session.sample.p_base_tip - tool).norm(), 1e-12);
}

TEST(RemoteDevice, NeverJumpsForAnyClutchSequence) {
  Random random(3);
  for (int pass = 0; pass < 50; ++pass) {
    Session session;
    Eigen::Vector3d before = session.feedback.p_base_tool;
    for (int i = 0; i < 40; ++i) {
      const bool is_engaged = random.below(2) == 0;
      const Eigen::Vector3d somewhere(random.uniform(-90.0, 90.0), random.uniform(-1.0, 1.0), 0.0);
      for (int k = 0; k < static_cast<int>(random.below(40)); ++k) {
        session.run_for(kCycle / 2.0, is_engaged, [&](double) { return somewhere; });
        const Eigen::Vector3d& tool = session.feedback.p_base_tool;
        ASSERT_LE((tool - before).norm(), 2.0 * kCycle + 1e-12);
        before = tool;
      }
    }
  }
}

TEST(RemoteDevice, FollowsATooFastHandAtItsSpeedLimit) {
  Session session;
  session.run_for(0.1, true, at_rest);
  const Eigen::Vector3d start = session.sample.p_base_tip;
  session.run_for(0.1, true, [](double) { return Eigen::Vector3d(3.0, 2.0, 3.0); });
  const double moved = (session.sample.p_base_tip - start).norm();
  EXPECT_GT(moved, 0.1);
  EXPECT_LE(moved, 2.0 * 0.1 + 1e-9);
  session.run_for(1.2, true, [](double) { return Eigen::Vector3d(3.0, 2.0, 3.0); });
  EXPECT_NEAR((session.sample.p_base_tip - start).norm(), 2.0, 1e-9);
}

TEST(RemoteDevice, OpensInTheCycleInWhichTheOpenClutchArrives) {
  Session session;
  session.run_for(0.5, true, along_x);
  ASSERT_TRUE(session.sample.is_engaged);
  ASSERT_TRUE(session.device.push(sample_at(session.next, along_x(session.next), false)));
  EXPECT_FALSE(session.device.exchange(session.t, kCycle, session.feedback).is_engaged);
}

TEST(RemoteDevice, OpensAfterATimeoutOfHalfASecondUntilTheClutchIsReopened) {
  Session session;
  session.run_for(0.5, true, at_rest);
  session.stay_silent(0.45);
  EXPECT_TRUE(session.sample.is_engaged);
  session.stay_silent(0.1);
  EXPECT_FALSE(session.sample.is_engaged);
  EXPECT_FALSE(session.sample.is_present);
  session.run_for(0.2, true, at_rest);
  EXPECT_TRUE(session.sample.is_present);
  EXPECT_FALSE(session.sample.is_engaged);
  session.run_for(0.1, false, at_rest);
  session.run_for(0.1, true, at_rest);
  EXPECT_TRUE(session.sample.is_engaged);
}

TEST(RemoteDevice, RejectsAndCountsInvalidSamples) {
  RemoteDevice device;
  const RemoteSample good = sample_at(1.0, {1.0, 2.0, 3.0}, false);
  const auto rejects = [&](auto corrupt) {
    RemoteSample bad = good;
    corrupt(bad);
    return !device.push(bad);
  };
  EXPECT_TRUE(rejects([](RemoteSample& s) { s.p_base_tip.y() = kNan; }));
  EXPECT_TRUE(rejects([](RemoteSample& s) { s.p_base_tip.y() = 101.0; }));
  EXPECT_TRUE(rejects([](RemoteSample& s) { s.p_base_tip.x() = -1e308; }));
  EXPECT_TRUE(rejects([](RemoteSample& s) { s.q_base_tool.coeffs().setZero(); }));
  EXPECT_TRUE(rejects([](RemoteSample& s) { s.q_base_tool.x() = kNan; }));
  EXPECT_TRUE(rejects([](RemoteSample& s) { s.sender_clock = kNan; }));
  EXPECT_TRUE(
      rejects([](RemoteSample& s) { s.arrival = std::numeric_limits<double>::infinity(); }));
  EXPECT_EQ(device.rejected(), 7u);
  EXPECT_TRUE(device.push(good));
  EXPECT_FALSE(device.push(good)) << "again";
  EXPECT_FALSE(device.push(sample_at(0.9, {1.0, 2.0, 3.0}, false))) << "out of order";
  EXPECT_FALSE(device.push(sample_at(1.001, {1.0, 2.0, 3.0}, false))) << "a flood";
  EXPECT_TRUE(device.push(sample_at(1.001, {1.0, 2.0, 3.0}, true))) << "the clutch counts";
  EXPECT_EQ(device.rejected(), 10u);
}

TEST(RemoteDevice, RejectsSamplesWhenTheQueueIsFull) {
  RemoteDevice device;
  for (int i = 0; i < 1000; ++i)
    (void)device.push(sample_at(i * kInterval, {i * 0.01, 0, 0}, true));
  EXPECT_EQ(device.rejected(), 1000u - 64u);
  (void)device.exchange(63 * kInterval, kCycle, {});
  EXPECT_DOUBLE_EQ(device.status().sender_clock, 63 * kInterval);
}

TEST(RemoteDevice, ReportsTheUsedSampleAndItsAge) {
  Session session;
  session.run_for(0.5, true, at_rest);
  const RemoteStatus status = session.device.status();
  EXPECT_DOUBLE_EQ(status.sender_clock, session.next - kInterval);
  EXPECT_NEAR(status.age, session.t - kCycle - status.sender_clock, 1e-9);
  EXPECT_LT(status.shown_clock, status.sender_clock + 1e-9);
  EXPECT_NEAR(status.delay, kInterval + kCycle, 1e-9);
}

TEST(RemoteDevice, DiscardsSamplesOfADisconnectedSender) {
  Session session;
  session.run_for(0.5, true, at_rest);
  ASSERT_TRUE(session.device.push(sample_at(session.next, at_rest(0.0), true)));
  session.device.release();
  const DeviceSample sample = session.device.exchange(session.t, kCycle, session.feedback);
  EXPECT_FALSE(sample.is_engaged);
  EXPECT_FALSE(sample.is_present);
  EXPECT_TRUE(std::isnan(session.device.status().sender_clock));
  // The next sender's clock may be an hour behind.
  EXPECT_TRUE(session.device.push(sample_at(-3600.0, at_rest(0.0), false, 1)));
}

TEST(RemoteDevice, KeepsASeparateOffsetForAnotherSender) {
  Session session;
  session.run_for(0.5, true, at_rest);
  const Eigen::Vector3d tool = session.feedback.p_base_tool;
  RemoteSample other = sample_at(77.0, {-5.0, 0.0, 0.0}, true, 1);
  other.arrival = session.t;
  ASSERT_TRUE(session.device.push(other));
  const DeviceSample sample = session.device.exchange(session.t, kCycle, session.feedback);
  EXPECT_TRUE(sample.is_engaged);
  EXPECT_LT((sample.p_base_tip - tool).norm(), 1e-12);
  EXPECT_EQ(session.device.status().sender, 1u);
}

TEST(RemoteDevice, RestartsAfterAClockJump) {
  Session session;
  session.run_for(0.5, true, at_rest);
  const Eigen::Vector3d tool = session.feedback.p_base_tool;
  RemoteSample later = sample_at(session.next + 3600.0, {-5.0, 0.0, 0.0}, true);
  later.arrival = session.t;
  ASSERT_TRUE(session.device.push(later));
  const DeviceSample sample = session.device.exchange(session.t, kCycle, session.feedback);
  EXPECT_LT((sample.p_base_tip - tool).norm(), 1e-12);
  EXPECT_LT(session.device.status().delay, 0.05);
}

TEST(RemoteDevice, RestartsAfterAClockThatStoppedDuringATimeout) {
  RemoteDevice device;
  const DeviceFeedback feedback{.p_base_tool = {0.5, 0.1, 0.2}};
  ASSERT_TRUE(device.push(sample_at(1.0, {0.0, 0.0, 0.0}, false)));
  (void)device.exchange(1.0, kCycle, feedback);
  RemoteSample again = sample_at(1.0, {1.0, 0.0, 0.0}, true);
  again.arrival = 1.6;
  ASSERT_TRUE(device.push(again));
  const DeviceSample sample = device.exchange(1.6, kCycle, feedback);
  EXPECT_TRUE(sample.is_engaged);
  EXPECT_LT((sample.p_base_tip - feedback.p_base_tool).norm(), 1e-12);
}

TEST(RemoteDevice, DoesNotEngageAtAnInvalidToolPosition) {
  RemoteDevice device;
  ASSERT_TRUE(device.push(sample_at(0.0, {1.0, 2.0, 3.0}, true)));
  const DeviceFeedback nowhere{.p_base_tool = Eigen::Vector3d::Constant(kNan)};
  const DeviceSample sample = device.exchange(0.0, kCycle, nowhere);
  EXPECT_FALSE(sample.is_engaged);
  EXPECT_TRUE(sample.p_base_tip.allFinite());
}

}  // namespace
}  // namespace pcavr
