// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/teleoperation/link/command_buffer.hpp"
#include "pcavr/teleoperation/link/motion_limiter.hpp"

namespace pcavr {
namespace {

constexpr double kCycle = 0.001;

MotionLimits small_workspace() {
  MotionLimits limits;
  limits.min_x = limits.min_y = limits.min_z = -0.2;
  limits.max_x = limits.max_y = limits.max_z = 0.3;
  return limits;
}

bool is_active(const MotionLimiter& limiter, LinkLimit limit) {
  return (limiter.active() & static_cast<std::uint32_t>(limit)) != 0;
}

// Commands that jump, lie outside, are not finite, or are absent.
TEST(MotionLimiter, KeepsEveryLimitWhateverIsCommanded) {
  const MotionLimits limits = small_workspace();
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    MotionLimiter limiter(limits, Eigen::Vector3d::Zero());
    Eigen::Vector3d before = limiter.v_base();
    std::optional<Eigen::Vector3d> command;
    for (int i = 0; i < 5000; ++i) {
      if (random.uniform() < 0.02) {
        command = Eigen::Vector3d(random.normal(), random.normal(), random.normal());
      }
      if (random.uniform() < 0.005) command.reset();
      if (random.uniform() < 0.002) {
        command = Eigen::Vector3d(0.1, std::numeric_limits<double>::quiet_NaN(), 0.1);
      }
      const Eigen::Vector3d force(random.uniform() < 0.1 ? 200.0 : 1.0, 0.0, 0.0);
      limiter.step(command, force, kCycle);
      ASSERT_LE(limiter.v_base().cwiseAbs().maxCoeff(), limits.max_speed + 1e-12);
      ASSERT_LE((limiter.v_base() - before).cwiseAbs().maxCoeff(),
                limits.max_acceleration * kCycle + 1e-9);
      ASSERT_TRUE((limiter.p_base().array() >= limits.workspace_min().array()).all());
      ASSERT_TRUE((limiter.p_base().array() <= limits.workspace_max().array()).all());
      before = limiter.v_base();
    }
  }
}

TEST(MotionLimiter, FollowsAHandWithoutActing) {
  MotionLimiter limiter(small_workspace(), Eigen::Vector3d::Zero());
  for (int i = 1; i < 2000; ++i) {
    // 50 mm at 0.5 Hz
    const Eigen::Vector3d hand(0.05 * (1.0 - std::cos(M_PI * kCycle * i)), 0.0, 0.0);
    limiter.step(hand, Eigen::Vector3d::Zero(), kCycle);
    EXPECT_NEAR(limiter.p_base().x(), hand.x(), 0.003);
    EXPECT_FALSE(is_active(limiter, LinkLimit::speed));
    EXPECT_FALSE(is_active(limiter, LinkLimit::workspace));
  }
}

TEST(MotionLimiter, ReachesItsTargetWithoutOvershoot) {
  MotionLimiter limiter(small_workspace(), Eigen::Vector3d::Zero());
  for (int i = 0; i < 1500; ++i) {
    limiter.step(Eigen::Vector3d(0.1, 0.0, 0.0), Eigen::Vector3d::Zero(), kCycle);
    EXPECT_LE(limiter.p_base().x(), 0.1 + 1e-6);
  }
  EXPECT_NEAR(limiter.p_base().x(), 0.1, 1e-5);
}

// A steady push; then a hand that stops at once.
TEST(MotionLimiter, DoesNotLagBehindAPushAndPassesItsStopByNoMoreThanStated) {
  const MotionLimits limits = small_workspace();
  for (const double speed : {0.08, 0.3}) {
    MotionLimiter limiter(limits, Eigen::Vector3d::Zero());
    double hand = 0.0;
    for (int i = 1; i <= 600; ++i) {
      hand += kCycle * std::min(speed, 2.0 * kCycle * i);  // from rest, at 2 m/s^2
      limiter.step(Eigen::Vector3d(hand, 0.0, 0.0), Eigen::Vector3d::Zero(), kCycle);
      EXPECT_TRUE(speed > 0.1 || std::abs(limiter.p_base().x() - hand) < 2e-5) << i;
    }
    double farthest = 0.0;
    for (int i = 0; i < 300; ++i) {
      limiter.step(Eigen::Vector3d(hand, 0.0, 0.0), Eigen::Vector3d::Zero(), kCycle);
      farthest = std::max(farthest, limiter.p_base().x() - hand);
    }
    EXPECT_LE(farthest, limits.max_overshoot + 1e-9);
    EXPECT_NEAR(limiter.p_base().x(), hand, 1e-5);
  }
}

TEST(MotionLimiter, HoldsWithinTheStatedTime) {
  const MotionLimits limits = small_workspace();
  MotionLimiter limiter(limits, Eigen::Vector3d(-0.2, 0.0, 0.0));
  for (int i = 0; i < 250; ++i) {
    limiter.step(Eigen::Vector3d(0.3, 0.0, 0.0), Eigen::Vector3d::Zero(), kCycle);
  }
  EXPECT_GT(limiter.v_base().x(), 0.2);
  const int cycles = static_cast<int>(std::ceil(limits.max_hold_time() / kCycle)) + 1;
  for (int i = 0; i < cycles; ++i) limiter.step(std::nullopt, Eigen::Vector3d::Zero(), kCycle);
  EXPECT_EQ(limiter.v_base(), Eigen::Vector3d::Zero());
}

TEST(MotionLimiter, DoesNotPressOnBeyondTheForceButRetracts) {
  MotionLimits limits = small_workspace();
  limits.max_force = 10.0;
  MotionLimiter limiter(limits, Eigen::Vector3d::Zero());
  const Eigen::Vector3d pressing(20.0, 0.0, 0.0);
  for (int i = 0; i < 300; ++i) limiter.step(Eigen::Vector3d(0.1, 0.0, 0.0), pressing, kCycle);
  EXPECT_EQ(limiter.p_base().x(), 0.0);
  EXPECT_TRUE(is_active(limiter, LinkLimit::force));
  for (int i = 0; i < 300; ++i) limiter.step(Eigen::Vector3d(-0.02, 0.0, 0.0), pressing, kCycle);
  EXPECT_LT(limiter.p_base().x(), -0.01);
}

TEST(MotionLimiter, DoesNotPressOnWithFrictionThatTurns) {
  MotionLimits limits = small_workspace();
  limits.max_force = 10.0;
  MotionLimiter limiter(limits, Eigen::Vector3d::Zero());
  const Eigen::Vector3d command(0.05, 0.0, -0.02);
  for (int i = 0; i < 600; ++i) {
    const double friction = i / 10 % 2 == 0 ? 8.0 : -8.0;  // [N]
    limiter.step(command, {friction, 0.0, -20.0}, kCycle);
  }
  EXPECT_EQ(limiter.p_base().z(), 0.0);
}

// The wall takes the part of the motion along x that would have lifted the tool off.
TEST(MotionLimiter, DoesNotPressOnAlongAWall) {
  MotionLimits limits = small_workspace();
  limits.max_force = 10.0;
  const Eigen::Vector3d at_wall(limits.max_x, 0.0, 0.0);
  MotionLimiter limiter(limits, at_wall);
  const Eigen::Vector3d pressing(-4.0, 0.0, -20.0);
  const auto follow = [&](const Eigen::Vector3d& command) {
    for (int i = 0; i < 300; ++i) limiter.step(command, pressing, kCycle);
  };
  follow(at_wall + Eigen::Vector3d(0.05, 0.0, -0.001));
  EXPECT_NEAR((limiter.p_base() - at_wall).dot(pressing.normalized()), 0.0, 1e-6);
  follow(at_wall + Eigen::Vector3d(0.05, 0.02, -0.001));  // beside it may move
  EXPECT_NEAR(limiter.p_base().y(), 0.02, 1e-6);
  EXPECT_NEAR(limiter.p_base().z(), 0.0, 1e-6);
}

LinkCommand command_for(double t) {
  LinkCommand command;
  command.t = t;
  return command;
}

TEST(CommandBuffer, ExecutesInOrderAtTheirTimes) {
  CommandBuffer buffer{CommandOptions()};
  EXPECT_TRUE(buffer.add(command_for(1.002), 0.9));
  EXPECT_TRUE(buffer.add(command_for(1.001), 0.9));
  EXPECT_TRUE(buffer.take_due(1.0).empty());
  const std::vector<LinkCommand> due = buffer.take_due(1.0025);
  ASSERT_EQ(due.size(), 2U);
  EXPECT_DOUBLE_EQ(due[0].t, 1.001);
  EXPECT_DOUBLE_EQ(due[1].t, 1.002);
  EXPECT_NEAR(*buffer.take_min_lead(), 0.101, 1e-12);
}

TEST(CommandBuffer, DiscardsStaleFutureRepeatedAndSupersededOnes) {
  const CommandOptions options;
  CommandBuffer buffer(options);
  EXPECT_FALSE(buffer.add(command_for(1.0 - options.max_age - 0.001), 1.0));
  EXPECT_FALSE(buffer.add(command_for(1.0 + options.max_lead + 0.001), 1.0));
  EXPECT_FALSE(buffer.add(command_for(1e9), 1.0));
  EXPECT_TRUE(buffer.add(command_for(1.0), 1.0));
  EXPECT_FALSE(buffer.add(command_for(1.0), 1.0));
  EXPECT_EQ(buffer.take_due(1.0).size(), 1U);
  EXPECT_FALSE(buffer.add(command_for(0.999), 1.0));
  EXPECT_EQ(buffer.discarded(), 5U);
}

// Two of three commands are lost: the tool goes on between those that are left.
TEST(CommandBuffer, LeadsTheToolPastLostCommands) {
  CommandBuffer buffer{CommandOptions()};
  const auto command_at = [](double t, float x) {
    LinkCommand command = command_for(t);
    command.p_base_tip.x() = x;
    command.is_engaged = true;
    return command;
  };
  EXPECT_TRUE(buffer.add(command_at(1.0, 0.1F), 0.9));
  EXPECT_TRUE(buffer.add(command_at(1.003, 0.4F), 0.9));
  EXPECT_FALSE(buffer.p_base_at(0.95));
  EXPECT_EQ(buffer.take_due(1.0).size(), 1U);
  EXPECT_NEAR(buffer.p_base_at(1.001)->x(), 0.2, 1e-6);
  EXPECT_NEAR(buffer.p_base_at(1.002)->x(), 0.3, 1e-6);
  EXPECT_EQ(buffer.take_due(1.003).size(), 1U);
  EXPECT_FALSE(buffer.p_base_at(1.003));
  LinkCommand open = command_at(1.004, 0.9F);
  open.is_engaged = false;
  EXPECT_TRUE(buffer.add(open, 1.003));
  EXPECT_FALSE(buffer.p_base_at(1.0035));
}

// The site did not run for a while: nothing that waited is executed late.
TEST(CommandBuffer, DiscardsWhatHasBecomeStaleWhileItWaited) {
  CommandBuffer buffer{CommandOptions()};
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(buffer.add(command_for(1.0 + 0.001 * i), 1.0));
  EXPECT_TRUE(buffer.take_due(5.0).empty());
  EXPECT_EQ(buffer.discarded(), 100U);
}

}  // namespace
}  // namespace pcavr
