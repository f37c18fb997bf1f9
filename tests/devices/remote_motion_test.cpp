// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
//
// A RemoteDevice's tip, compared with a known motion.
#include <gtest/gtest.h>

#include "devices/jittered_hand.hpp"

namespace pcavr {
namespace {

using test::CirclingHand;
using test::kCycle;
using test::Link;

constexpr double kDuration = 3.0;  // [s]
constexpr double kSettled = 0.5;   // [s] after which the jitter is known

class OverLinks : public testing::TestWithParam<Link> {};

INSTANTIATE_TEST_SUITE_P(RemoteMotion, OverLinks,
                         testing::Values(Link{1.0 / 30.0}, Link{1.0 / 60.0}, Link{1.0 / 72.0},
                                         Link{1.0 / 90.0}, Link{1.0 / 60.0, 0.02, 0.0},
                                         Link{1.0 / 60.0, 0.002, 0.012, -5.0}));

TEST_P(OverLinks, IsTheHandsPositionAtThePlayoutTime) {
  const Link link = GetParam();
  RemoteDevice device;
  const DeviceFeedback feedback{.p_base_tool = CirclingHand()(0.0)};
  double worst = 0.0;
  test::run(device, test::sent_over(link, kDuration, 1), kDuration, feedback,
            [&](double, const DeviceSample& sample) {
              if (!sample.is_engaged) return;
              const double shown = std::max(device.status().shown_clock - link.clock_offset, 0.0);
              worst = std::max(worst, (sample.p_base_tip - CirclingHand()(shown)).norm());
            });
  // A chord's distance from its arc is a h^2 / 8; the rest is the clocks' rounding.
  EXPECT_LT(worst, CirclingHand::kAcceleration * link.interval * link.interval / 8.0 + 1e-9);
  EXPECT_GT(worst, 0.0);
}

TEST_P(OverLinks, IsDelayedByAnIntervalPlusTheJitter) {
  const Link link = GetParam();
  RemoteDevice device;
  double sum = 0.0;
  int cycles = 0;
  test::run(device, test::sent_over(link, kDuration, 2), kDuration, {},
            [&](double t, const DeviceSample&) {
              if (t < kSettled) return;
              const double behind = t - (device.status().shown_clock - link.clock_offset);
              EXPECT_LT(behind, link.latency + link.interval + link.jitter + 3.0 * kCycle);
              EXPECT_LT(device.status().delay, link.interval + link.jitter + kCycle + 1e-6);
              EXPECT_GT(device.status().delay, link.interval - 1e-6);
              sum += behind;
              ++cycles;
            });
  EXPECT_LT(sum / cycles, link.latency + link.interval + link.jitter + kCycle + 1e-6);
}

TEST_P(OverLinks, HasNoStepsAtTheRateOfTheSamples) {
  const Link link = GetParam();
  RemoteDevice device;
  Eigen::Vector3d before = Eigen::Vector3d::Zero();
  double fastest = 0.0;
  int cycles = 0;
  int slow = 0;
  test::run(device, test::sent_over(link, kDuration, 3), kDuration, {},
            [&](double t, const DeviceSample& sample) {
              const double speed = (sample.p_base_tip - before).norm() / kCycle;
              before = sample.p_base_tip;
              if (t < kSettled) return;
              fastest = std::max(fastest, speed);
              ++cycles;
              if (speed < 0.75 * CirclingHand::kSpeed) ++slow;
            });
  // Delay changes by jitter change the speed; one arrival in 32 may be later than the delay.
  // With steps the tip would stop in 15 cycles of 16, and move 16 times too fast in one.
  EXPECT_LT(fastest, 1.25 * CirclingHand::kSpeed);
  EXPECT_LT(slow, cycles / 200);
}

TEST(RemoteMotion, StopsForALateSampleAndCatchesUpWithoutAJump) {
  std::vector<RemoteSample> samples = test::sent_over({}, kDuration, 4);
  // The page stutters for 0.1 s: its samples arrive together after that.
  for (RemoteSample& sample : samples) {
    if (sample.arrival > 1.5 && sample.arrival < 1.6) sample.arrival = 1.6;
  }
  RemoteDevice device;
  Eigen::Vector3d before = Eigen::Vector3d::Zero();
  bool waited = false;
  test::run(device, samples, kDuration, {}, [&](double t, const DeviceSample& sample) {
    const double moved = (sample.p_base_tip - before).norm();
    before = sample.p_base_tip;
    if (t < kSettled) return;
    if (t > 1.5 && t < 1.6 && moved == 0.0) waited = true;
    // 0.1 s behind: catches up at three times the speed.
    EXPECT_LT(moved, 3.5 * CirclingHand::kSpeed * kCycle) << t;
  });
  EXPECT_TRUE(waited);
  EXPECT_LT(device.status().delay, 0.03);
}

TEST(RemoteMotion, HasAMaximumDelayOf50Milliseconds) {
  const Link bad{.interval = 0.1, .latency = 0.01, .jitter = 0.3};
  RemoteDevice device;
  test::run(device, test::sent_over(bad, kDuration, 8), kDuration, {},
            [&](double, const DeviceSample&) { EXPECT_LE(device.status().delay, 0.05 + 1e-9); });
  EXPECT_GT(device.status().delay, 0.049);
}

TEST(RemoteMotion, NeverLeavesTheHandsPath) {
  // A hand that moves at 1 m/s and stops abruptly.
  RemoteDevice device;
  std::vector<RemoteSample> samples;
  for (int i = 0; i < 60; ++i) {
    const double t = i / 60.0;
    samples.push_back({.p_base_tip = {std::min(t, 0.5), 0.0, 0.0},
                       .is_engaged = true,
                       .sender_clock = t,
                       .arrival = t + 0.002});
  }
  test::run(device, samples, 1.0, {}, [&](double, const DeviceSample& sample) {
    EXPECT_LE(sample.p_base_tip.x(), 0.5 + 1e-12);
    EXPECT_GE(sample.p_base_tip.x(), 0.0);
  });
}

TEST(RemoteMotion, IsDeterministicToTheBit) {
  std::vector<double> first_pass;
  for (int pass = 0; pass < 2; ++pass) {
    RemoteDevice device;
    std::size_t i = 0;
    test::run(device, test::sent_over({}, 1.0, 5), 1.0, {},
              [&](double, const DeviceSample& sample) {
                if (pass == 0) {
                  first_pass.push_back(sample.p_base_tip.x());
                } else {
                  EXPECT_EQ(sample.p_base_tip.x(), first_pass[i++]);
                }
              });
  }
}

TEST(RemoteMotion, RotatesWithTheHand) {
  RemoteDevice device;
  const Eigen::Quaterniond quarter(Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitZ()));
  std::vector<RemoteSample> samples;
  for (int i = 0; i < 60; ++i) {
    const double t = i / 60.0;
    samples.push_back({.q_base_tool = Eigen::Quaterniond::Identity().slerp(t, quarter),
                       .sender_clock = t,
                       .arrival = t});
  }
  samples[30].q_base_tool.coeffs() *= 3.0;  // is normalized, not rejected
  test::run(device, samples, 0.98, {}, [&](double t, const DeviceSample& sample) {
    if (t < 0.1) return;
    const double angle = sample.q_base_tool.angularDistance(Eigen::Quaterniond::Identity());
    EXPECT_NEAR(angle, M_PI / 2.0 * device.status().shown_clock, 1e-6);
    EXPECT_NEAR(sample.q_base_tool.norm(), 1.0, 1e-9);
  });
}

}  // namespace
}  // namespace pcavr
