// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/devices/remote_device.hpp"

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

/// A device whose page sends every 1/64 s for as long as it is held or free; a tool that follows.
struct Session {
  RemoteDevice device;
  DeviceFeedback feedback{.p_base_tool = {0.5, 0.1, 0.2}};
  DeviceSample said;
  double t = 0.0;
  double next = 0.0;

  /// Goes on for `duration` with the hand at `tip(t)`.
  template <typename Tip>
  void go_on(double duration, bool is_engaged, const Tip& tip) {
    for (const double end = t + duration; t < end; t += kCycle) {
      for (; next <= t; next += kInterval)
        (void)device.push(sample_at(next, tip(next), is_engaged));
      said = device.exchange(t, kCycle, feedback);
      if (said.is_engaged) feedback.p_base_tool = said.p_base_tip;
    }
  }
  void stay_silent(double duration) {
    for (const double end = t + duration; t < end; t += kCycle) {
      said = device.exchange(t, kCycle, feedback);
    }
    next = t;
  }
};

Eigen::Vector3d at_rest(double) { return {1.0, 2.0, 3.0}; }
Eigen::Vector3d along_x(double t) { return {0.1 * t, 2.0, 3.0}; }

TEST(RemoteDevice, IsAbsentBeforeTheFirstSample) {
  RemoteDevice device;
  const DeviceSample said = device.exchange(0.0, kCycle, {});
  EXPECT_FALSE(said.is_present);
  EXPECT_FALSE(said.is_engaged);
  EXPECT_TRUE(std::isnan(device.use().sender_clock));
  EXPECT_EQ(device.name(), "remote");
}

TEST(RemoteDevice, ClosesItsClutchWhereTheToolIs) {
  Session session;
  session.go_on(0.2, false, at_rest);
  EXPECT_TRUE(session.said.is_present);
  EXPECT_FALSE(session.said.is_engaged);
  session.go_on(0.2, true, at_rest);
  EXPECT_TRUE(session.said.is_engaged);
  EXPECT_LT((session.said.p_base_tip - Eigen::Vector3d(0.5, 0.1, 0.2)).norm(), 1e-12);
}

TEST(RemoteDevice, MovesTheToolByWhatTheHandMovesWhileHeldAndByNothingElse) {
  Session session;
  session.go_on(1.0, false, along_x);
  const double from = session.next;
  session.go_on(1.0, true, along_x);
  const double held_until = session.device.use().shown_clock;
  const Eigen::Vector3d tool = session.feedback.p_base_tool;
  EXPECT_NEAR(tool.x(), 0.5 + 0.1 * (held_until - from), 1e-9);
  EXPECT_NEAR(tool.y(), 0.1, 1e-12);
  session.go_on(1.0, false, along_x);
  EXPECT_EQ(session.feedback.p_base_tool, tool);
  session.go_on(0.016, true, along_x);
  EXPECT_TRUE(session.said.is_engaged);
  EXPECT_LT((session.said.p_base_tip - tool).norm(), 1e-12);
}

TEST(RemoteDevice, NeverJumpsHoweverTheClutchIsPlayed) {
  Random random(3);
  for (int pass = 0; pass < 50; ++pass) {
    Session session;
    Eigen::Vector3d before = session.feedback.p_base_tool;
    for (int i = 0; i < 40; ++i) {
      const bool is_engaged = random.below(2) == 0;
      const Eigen::Vector3d somewhere(random.uniform(-90.0, 90.0), random.uniform(-1.0, 1.0), 0.0);
      for (int k = 0; k < static_cast<int>(random.below(40)); ++k) {
        session.go_on(kCycle / 2.0, is_engaged, [&](double) { return somewhere; });
        const Eigen::Vector3d& tool = session.feedback.p_base_tool;
        ASSERT_LE((tool - before).norm(), 2.0 * kCycle + 1e-12);
        before = tool;
      }
    }
  }
}

TEST(RemoteDevice, FollowsAHandThatIsTooFastAtItsBound) {
  Session session;
  session.go_on(0.1, true, at_rest);
  const Eigen::Vector3d start = session.said.p_base_tip;
  session.go_on(0.1, true, [](double) { return Eigen::Vector3d(3.0, 2.0, 3.0); });
  const double moved = (session.said.p_base_tip - start).norm();
  EXPECT_GT(moved, 0.1);
  EXPECT_LE(moved, 2.0 * 0.1 + 1e-9);
  session.go_on(1.2, true, [](double) { return Eigen::Vector3d(3.0, 2.0, 3.0); });
  EXPECT_NEAR((session.said.p_base_tip - start).norm(), 2.0, 1e-9);
}

TEST(RemoteDevice, LetsGoInTheCycleInWhichTheOpenedClutchArrives) {
  Session session;
  session.go_on(0.5, true, along_x);
  ASSERT_TRUE(session.said.is_engaged);
  ASSERT_TRUE(session.device.push(sample_at(session.next, along_x(session.next), false)));
  EXPECT_FALSE(session.device.exchange(session.t, kCycle, session.feedback).is_engaged);
}

TEST(RemoteDevice, LetsGoAfterHalfASecondOfSilenceUntilTheClutchWasOpened) {
  Session session;
  session.go_on(0.5, true, at_rest);
  session.stay_silent(0.45);
  EXPECT_TRUE(session.said.is_engaged);
  session.stay_silent(0.1);
  EXPECT_FALSE(session.said.is_engaged);
  EXPECT_FALSE(session.said.is_present);
  session.go_on(0.2, true, at_rest);
  EXPECT_TRUE(session.said.is_present);
  EXPECT_FALSE(session.said.is_engaged);
  session.go_on(0.1, false, at_rest);
  session.go_on(0.1, true, at_rest);
  EXPECT_TRUE(session.said.is_engaged);
}

TEST(RemoteDevice, LeavesOutWhatCannotBeAndCountsIt) {
  RemoteDevice device;
  const RemoteSample good = sample_at(1.0, {1.0, 2.0, 3.0}, false);
  const auto refuses = [&](auto spoil) {
    RemoteSample bad = good;
    spoil(bad);
    return !device.push(bad);
  };
  EXPECT_TRUE(refuses([](RemoteSample& s) { s.p_base_tip.y() = kNan; }));
  EXPECT_TRUE(refuses([](RemoteSample& s) { s.p_base_tip.y() = 101.0; }));
  EXPECT_TRUE(refuses([](RemoteSample& s) { s.p_base_tip.x() = -1e308; }));
  EXPECT_TRUE(refuses([](RemoteSample& s) { s.q_base_tool.coeffs().setZero(); }));
  EXPECT_TRUE(refuses([](RemoteSample& s) { s.q_base_tool.x() = kNan; }));
  EXPECT_TRUE(refuses([](RemoteSample& s) { s.sender_clock = kNan; }));
  EXPECT_TRUE(
      refuses([](RemoteSample& s) { s.arrival = std::numeric_limits<double>::infinity(); }));
  EXPECT_EQ(device.left_out(), 7u);
  EXPECT_TRUE(device.push(good));
  EXPECT_FALSE(device.push(good)) << "again";
  EXPECT_FALSE(device.push(sample_at(0.9, {1.0, 2.0, 3.0}, false))) << "out of order";
  EXPECT_FALSE(device.push(sample_at(1.001, {1.0, 2.0, 3.0}, false))) << "a flood";
  EXPECT_TRUE(device.push(sample_at(1.001, {1.0, 2.0, 3.0}, true))) << "the clutch counts";
  EXPECT_EQ(device.left_out(), 10u);
}

TEST(RemoteDevice, LeavesOutWhatItHasNoRoomFor) {
  RemoteDevice device;
  for (int i = 0; i < 1000; ++i)
    (void)device.push(sample_at(i * kInterval, {i * 0.01, 0, 0}, true));
  EXPECT_EQ(device.left_out(), 1000u - 64u);
  (void)device.exchange(63 * kInterval, kCycle, {});
  EXPECT_DOUBLE_EQ(device.use().sender_clock, 63 * kInterval);
}

TEST(RemoteDevice, SaysWhichSampleItUsedAndHowOldItIs) {
  Session session;
  session.go_on(0.5, true, at_rest);
  const RemoteUse use = session.device.use();
  EXPECT_DOUBLE_EQ(use.sender_clock, session.next - kInterval);
  EXPECT_NEAR(use.age, session.t - kCycle - use.sender_clock, 1e-9);
  EXPECT_LT(use.shown_clock, use.sender_clock + 1e-9);
  EXPECT_NEAR(use.delay, kInterval + kCycle, 1e-9);
}

TEST(RemoteDevice, ForgetsASenderThatIsGone) {
  Session session;
  session.go_on(0.5, true, at_rest);
  ASSERT_TRUE(session.device.push(sample_at(session.next, at_rest(0.0), true)));
  session.device.let_go();
  const DeviceSample said = session.device.exchange(session.t, kCycle, session.feedback);
  EXPECT_FALSE(said.is_engaged);
  EXPECT_FALSE(said.is_present);
  EXPECT_TRUE(std::isnan(session.device.use().sender_clock));
  // The next one's clock may be an hour younger.
  EXPECT_TRUE(session.device.push(sample_at(-3600.0, at_rest(0.0), false, 1)));
}

TEST(RemoteDevice, GivesAnotherSendersHandItsOwnGrip) {
  Session session;
  session.go_on(0.5, true, at_rest);
  const Eigen::Vector3d tool = session.feedback.p_base_tool;
  RemoteSample other = sample_at(77.0, {-5.0, 0.0, 0.0}, true, 1);
  other.arrival = session.t;
  ASSERT_TRUE(session.device.push(other));
  const DeviceSample said = session.device.exchange(session.t, kCycle, session.feedback);
  EXPECT_TRUE(said.is_engaged);
  EXPECT_LT((said.p_base_tip - tool).norm(), 1e-12);
  EXPECT_EQ(session.device.use().sender, 1u);
}

TEST(RemoteDevice, TakesAClockThatJumpsForAMotionThatStartsAnew) {
  Session session;
  session.go_on(0.5, true, at_rest);
  const Eigen::Vector3d tool = session.feedback.p_base_tool;
  RemoteSample later = sample_at(session.next + 3600.0, {-5.0, 0.0, 0.0}, true);
  later.arrival = session.t;
  ASSERT_TRUE(session.device.push(later));
  const DeviceSample said = session.device.exchange(session.t, kCycle, session.feedback);
  EXPECT_LT((said.p_base_tip - tool).norm(), 1e-12);
  EXPECT_LT(session.device.use().delay, 0.05);
}

TEST(RemoteDevice, TakesAClockThatStoodStillOverASilenceForAMotionThatStartsAnew) {
  RemoteDevice device;
  const DeviceFeedback feedback{.p_base_tool = {0.5, 0.1, 0.2}};
  ASSERT_TRUE(device.push(sample_at(1.0, {0.0, 0.0, 0.0}, false)));
  (void)device.exchange(1.0, kCycle, feedback);
  RemoteSample again = sample_at(1.0, {1.0, 0.0, 0.0}, true);
  again.arrival = 1.6;
  ASSERT_TRUE(device.push(again));
  const DeviceSample said = device.exchange(1.6, kCycle, feedback);
  EXPECT_TRUE(said.is_engaged);
  EXPECT_LT((said.p_base_tip - feedback.p_base_tool).norm(), 1e-12);
}

TEST(RemoteDevice, DoesNotCloseOnAToolThatIsNowhere) {
  RemoteDevice device;
  ASSERT_TRUE(device.push(sample_at(0.0, {1.0, 2.0, 3.0}, true)));
  const DeviceFeedback nowhere{.p_base_tool = Eigen::Vector3d::Constant(kNan)};
  const DeviceSample said = device.exchange(0.0, kCycle, nowhere);
  EXPECT_FALSE(said.is_engaged);
  EXPECT_TRUE(said.p_base_tip.allFinite());
}

}  // namespace
}  // namespace pcavr
