// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include <gtest/gtest.h>

#include "pcavr/teleoperation/haptics/haptic_tool.hpp"

#include "haptics/closed_paths.hpp"
#include "haptics/scanned_bumps.hpp"

namespace pcavr {
namespace {

using test::kCycle;
constexpr int kSteps = 250'000;

struct Count {
  long inside = 0;
  long pop_throughs = 0;
  long without_force = 0;
  long jumps = 0;
  long penetrations = 0;
  double lag = 0.0;  ///< [m] sum of the horizontal distances while deeper than 1 mm
  double max_lag = 0.0;
  long deep = 0;
};

Count press_and_slide(double noise, double radius, double friction) {
  const test::ScannedBumps bumps(707, noise, 5);
  HapticTool tool(bumps.mesh(), test::proxy_options(radius, friction), {});
  const test::PressAndSlide hand(17);
  Count count;
  // The tip comes from above.
  Eigen::Vector3d tip = hand(0.0) + Eigen::Vector3d(0.0, 0.0, 0.02);
  EXPECT_TRUE(tool.reset(tip));
  Eigen::Vector3d proxy = tip;
  for (int i = 1; i <= kSteps; ++i) {
    const double t = i * kCycle;
    const Eigen::Vector3d next = hand(t) + Eigen::Vector3d(0.0, 0.0, std::max(0.0, 0.02 - 0.1 * t));
    const HapticState state = tool.step(next, kCycle);
    if ((state.proxy - proxy).norm() > (next - tip).norm() + 1e-12) ++count.jumps;
    tip = next;
    proxy = state.proxy;
    const double below = bumps.height(tip.x(), tip.y()) - tip.z();
    const bool is_inside = below > 0.0 || bumps.distance(tip, radius) < radius - 1e-9;
    if (proxy.z() < bumps.height(proxy.x(), proxy.y())) ++count.pop_throughs;
    if (bumps.distance(proxy, radius) < radius - 1e-9) ++count.penetrations;
    if (!is_inside) continue;
    ++count.inside;
    if (state.force.norm() <= 0.0) ++count.without_force;
    if (below < 0.001) continue;
    ++count.deep;
    const double lag = (proxy - tip).head<2>().norm();
    count.lag += lag;
    count.max_lag = std::max(count.max_lag, lag);
  }
  std::printf(
      "noise %.1f mm, radius %.1f mm, friction %.1f: inside %ld of %d, mean lag %.2f mm, "
      "max %.2f mm\n",
      1e3 * noise, 1e3 * radius, friction, count.inside, kSteps,
      1e3 * count.lag / static_cast<double>(std::max(count.deep, 1L)), 1e3 * count.max_lag);
  return count;
}

void expect_valid(const Count& count) {
  EXPECT_GT(count.inside, kSteps / 2);
  EXPECT_EQ(count.pop_throughs, 0);
  EXPECT_EQ(count.without_force, 0);
  EXPECT_EQ(count.jumps, 0);
  EXPECT_EQ(count.penetrations, 0);
}

// Four times 250 000 steps on a million triangles.
TEST(MillionSteps, HaveNoPopThroughOrJumpOnASmoothScan) {
  expect_valid(press_and_slide(0.0, 0.001, 0.0));
}
TEST(MillionSteps, HaveNoPopThroughOrJumpOnANoisyScan) {
  expect_valid(press_and_slide(0.0003, 0.001, 0.0));
}
TEST(MillionSteps, HaveNoPopThroughOrJumpWithFriction) {
  expect_valid(press_and_slide(0.0003, 0.001, 0.4));
}
TEST(MillionSteps, HaveNoPopThroughOrJumpWithATinyProxy) {
  expect_valid(press_and_slide(0.0003, 0.0001, 0.0));
}

TEST(ClosedPaths, ArePassiveTenThousandTimes) {
  const test::ScannedBumps bumps(200, 0.0003, 3);
  for (const double friction : {0.0, 0.5}) {
    HapticTool tool(bumps.mesh(), test::proxy_options(0.001, friction), {});
    const test::Work work = test::over_closed_paths(tool, 5000);
    std::printf("friction %.1f: %ld paths touched, mean work %.3g J, min %.3g J, %ld below 0\n",
                friction, work.touched, work.sum / static_cast<double>(work.touched), work.min,
                work.active);
    EXPECT_GT(work.touched, 4000);
    EXPECT_GE(work.min, -test::kRounding);
  }
}

}  // namespace
}  // namespace pcavr
