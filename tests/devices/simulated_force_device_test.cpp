// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/devices/simulated_force_device.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/teleoperation/haptics/haptic_tool.hpp"

namespace pcavr {
namespace {

constexpr double kCycle = 0.001;   // [s]
constexpr double kRadius = 0.001;  // [m] of the tool's sphere
const Eigen::Vector3d kStart(0.0, 0.0, 0.02);

TriangleMesh floor_mesh() {
  TriangleMesh mesh;
  mesh.vertices = {
      {-1.0F, -1.0F, 0.0F}, {1.0F, -1.0F, 0.0F}, {1.0F, 1.0F, 0.0F}, {-1.0F, 1.0F, 0.0F}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

ProxyOptions proxy_options(double friction) {
  ProxyOptions options;
  options.radius = kRadius;
  options.friction = friction;
  return options;
}

ForceOptions force_options(double stiffness) {
  ForceOptions options;
  options.stiffness = stiffness;
  options.max_force = 100.0;
  options.rise_time = 1e-3;
  return options;
}

/// A hand with that target and noise [N], on motors of up to `max_force` [N].
SimulatedForceDeviceOptions hand_with(std::function<Eigen::Vector3d(double t)> target,
                                      double force_noise, double max_force) {
  SimulatedForceDeviceOptions options;
  options.target = std::move(target);
  options.force_noise = force_noise;
  options.max_force = max_force;
  return options;
}

SimulatedForceDeviceOptions hand_with_seed(std::uint64_t seed) {
  SimulatedForceDeviceOptions options;
  options.seed = seed;
  return options;
}

/// Device and floor in a closed loop, each with the other's output of the previous cycle.
struct ClosedLoop {
  SimulatedForceDevice device;
  HapticTool tool;
  DeviceFeedback feedback{.p_base_tool = kStart};
  DeviceSample sample;
  double t = 0.0;

  ClosedLoop(SimulatedForceDeviceOptions hand, double stiffness, double friction = 0.0)
      : device(std::move(hand)),
        tool(floor_mesh(), proxy_options(friction), force_options(stiffness)) {
    EXPECT_TRUE(tool.reset(kStart));
  }
  void step() {
    sample = device.exchange(t, kCycle, feedback);
    const HapticState state = tool.step(sample.p_base_tip, kCycle);
    feedback = {.p_base_tool = state.proxy, .force_base = state.force};
    t += kCycle;
  }
};

/// Target 1 cm below the floor.
Eigen::Vector3d into_the_floor(double) { return {0.0, 0.0, -0.03}; }

TEST(SimulatedForceDevice, ReachesTheHandsTargetInFreeSpace) {
  SimulatedForceDevice device(hand_with(into_the_floor, 0.0, 5.0));
  DeviceSample sample;
  for (int i = 0; i < 1000; ++i)
    sample = device.exchange(i * kCycle, kCycle, {.p_base_tool = kStart});
  EXPECT_TRUE(sample.is_engaged && sample.is_present);
  EXPECT_LT((sample.p_base_tip - Eigen::Vector3d(0.0, 0.0, -0.01)).norm(), 1e-6);
  EXPECT_EQ(device.motor_work(), 0.0);
}

TEST(SimulatedForceDevice, ComesToRestOnAFloorForAllStiffnesses) {
  for (const double stiffness : {200.0, 1000.0, 3000.0}) {
    for (const double hand_stiffness : {100.0, 400.0, 1000.0}) {
      for (const double mass : {0.1, 0.3}) {
        SimulatedForceDeviceOptions hand = hand_with(into_the_floor, 0.0, 100.0);
        hand.hand_stiffness = hand_stiffness;
        hand.mass = mass;
        ClosedLoop loop(hand, stiffness);
        for (int i = 0; i < 4000; ++i) loop.step();
        // Equilibrium of the two springs; the sphere's centre is a radius above the floor.
        const double rest =
            (hand_stiffness * -0.01 + stiffness * kRadius) / (hand_stiffness + stiffness);
        EXPECT_NEAR(loop.sample.p_base_tip.z(), rest, 1e-5)
            << stiffness << ' ' << hand_stiffness << ' ' << mass;
        EXPECT_LT(loop.device.v_base_tip().norm(), 1e-4);
      }
    }
  }
}

TEST(SimulatedForceDevice, IsPassiveOnAFloorUnderPeriodicContact) {
  for (const double stiffness : {200.0, 1000.0, 3000.0}) {
    for (const double rate : {1.0, 5.0, 20.0}) {
      const auto target = [rate](double t) {
        return Eigen::Vector3d(0.0, 0.0, -0.015 * (1.0 - std::cos(rate * t)));
      };
      ClosedLoop loop(hand_with(target, 0.0, 100.0), stiffness);
      double max_work = -1e9;
      for (int i = 0; i < 10'000; ++i) {
        loop.step();
        max_work = std::max(max_work, loop.device.motor_work());
      }
      // Tolerance: the contact model's minimum force, which is not passive, over its range.
      EXPECT_LT(max_work, 1e-6) << stiffness << ' ' << rate;
      EXPECT_LT(loop.device.motor_work(), 0.0);
    }
  }
}

TEST(SimulatedForceDevice, IsStableOnAFloorWithNoiseAndSaturation) {
  ClosedLoop loop(hand_with(into_the_floor, 0.05, 3.0), 1000.0, 0.3);
  double fastest = 0.0;
  for (int i = 0; i < 10'000; ++i) {
    loop.step();
    if (i > 2000) fastest = std::max(fastest, loop.device.v_base_tip().norm());
  }
  // Noise of 0.05 N a cycle on 0.2 kg is 0.25 mm/s a cycle, which the hand damps: no oscillation.
  EXPECT_GT(fastest, 0.0);
  EXPECT_LT(fastest, 0.01);
  // 400 N/m against at most 3 N: the motors can deflect the spring by at most 7.5 mm.
  EXPECT_LT(loop.sample.p_base_tip.z(), -0.001);
}

TEST(SimulatedForceDevice, IsDeterministicToTheBit) {
  ClosedLoop first({}, 1000.0);
  ClosedLoop second({}, 1000.0);
  ClosedLoop other(hand_with_seed(2), 1000.0);
  bool differs = false;
  for (int i = 0; i < 3000; ++i) {
    first.step();
    second.step();
    other.step();
    ASSERT_EQ(first.sample.p_base_tip, second.sample.p_base_tip);
    differs = differs || first.sample.p_base_tip != other.sample.p_base_tip;
  }
  EXPECT_TRUE(differs);
}

TEST(SimulatedForceDevice, IgnoresInvalidToolPositionsAndForces) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  SimulatedForceDevice device;
  DeviceFeedback feedback{.p_base_tool = Eigen::Vector3d::Constant(kNan)};
  EXPECT_FALSE(device.exchange(0.0, kCycle, feedback).is_present);
  feedback.p_base_tool = kStart;
  feedback.force_base = Eigen::Vector3d::Constant(kNan);
  const DeviceSample sample = device.exchange(kCycle, kCycle, feedback);
  EXPECT_TRUE(sample.is_present);
  EXPECT_TRUE(sample.p_base_tip.allFinite());
}

TEST(SimulatedForceDevice, RejectsOptionsOutOfRange) {
  const auto expect_rejected = [](double SimulatedForceDeviceOptions::*field, double value) {
    SimulatedForceDeviceOptions options;
    options.*field = value;
    EXPECT_THROW(SimulatedForceDevice{options}, ContractError);
  };
  expect_rejected(&SimulatedForceDeviceOptions::mass, 0.0);
  expect_rejected(&SimulatedForceDeviceOptions::hand_stiffness, -1.0);
  expect_rejected(&SimulatedForceDeviceOptions::max_force, INFINITY);
  expect_rejected(&SimulatedForceDeviceOptions::sway_period, 0.0);
}

}  // namespace
}  // namespace pcavr
