// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/options.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/teleoperation/devices/open_device.hpp"
#include "pcavr/teleoperation/devices/remote_device.hpp"

#include "support/option_defaults.hpp"
#include "teleoperation/devices/jitter_buffer.hpp"
#include "teleoperation/devices/rate_tip.hpp"

namespace pcavr {
namespace {

constexpr double kOptionCycle = 0.001;  // [s]

TEST(DeviceOptions, HaveTheirDocumentedDefaults) {
  test::expect_documented_defaults<RateOptions>();
  test::expect_documented_defaults<GamepadOptions>();
  test::expect_documented_defaults<SpaceMouseOptions>();
  test::expect_documented_defaults<RemoteDeviceOptions>();
  test::expect_documented_defaults<PluginDeviceOptions>();
  test::expect_documented_defaults<TraceDeviceOptions>();
  test::expect_documented_defaults<SimulatedForceDeviceOptions>();
}

TEST(DeviceOptions, RateIsTheSpeedAtFullDeflectionInTheDirectionFaced) {
  RateOptions options;
  options.max_speed = 0.05;
  options.facing = 1.5707963267948966;
  RateTip tip(options);
  const RateCommand away{Eigen::Vector3d::UnitX(), true, true};
  const Eigen::Vector3d tool(0.5, 0.1, 0.2);
  const Eigen::Vector3d first = tip.step(away, kOptionCycle, tool).p_base_tip;
  const Eigen::Vector3d moved = tip.step(away, kOptionCycle, tool).p_base_tip - first;
  EXPECT_NEAR((moved - Eigen::Vector3d(0.0, 5e-5, 0.0)).norm(), 0.0, 1e-12);
}

/// Displacement of an engaged remote tip in the 41 cycles after its hand jumped by 1 m.
double moved_after_a_jump(double max_speed) {
  RemoteDeviceOptions options;
  options.max_speed = max_speed;
  RemoteDevice device(options);
  double p = 0.0;
  for (int i = 0; i <= 140; ++i) {
    const double t = kOptionCycle * i;
    if (i % 10 == 0) {
      const Eigen::Vector3d hand(i < 100 ? 0.0 : 1.0, 0.0, 0.0);
      EXPECT_TRUE(device.push({hand, Eigen::Quaterniond::Identity(), true, t, t, 1}));
    }
    p = device.exchange(t, kOptionCycle, {}).p_base_tip.x();
  }
  return p;
}

TEST(DeviceOptions, MaximumSpeedLimitsAJumpOfTheHand) {
  EXPECT_LE(moved_after_a_jump(0.5), 0.5 * 0.041 + 1e-9);
  EXPECT_GT(moved_after_a_jump(5.0), 0.5 * 0.041);
}

TEST(DeviceOptions, TimeoutOpensTheClutch) {
  for (const double timeout : {0.1, 0.5}) {
    RemoteDeviceOptions options;
    options.timeout = timeout;
    RemoteDevice device(options);
    EXPECT_TRUE(
        device.push({Eigen::Vector3d::Zero(), Eigen::Quaterniond::Identity(), true, 0.0, 0.0, 1}));
    bool is_engaged_at_200_ms = false;
    for (int i = 0; i <= 200; ++i) {
      is_engaged_at_200_ms = device.exchange(kOptionCycle * i, kOptionCycle, {}).is_engaged;
    }
    EXPECT_EQ(is_engaged_at_200_ms, timeout > 0.2);
  }
}

TEST(DeviceOptions, SamplesBelowTheMinimumIntervalAreRejected) {
  for (const double min_interval : {0.002, 0.02}) {
    RemoteDeviceOptions options;
    options.min_interval = min_interval;
    RemoteDevice device(options);
    const auto push = [&](double t) {
      return device.push({Eigen::Vector3d::Zero(), Eigen::Quaterniond::Identity(), true, t, t, 1});
    };
    EXPECT_TRUE(push(0.0));
    EXPECT_EQ(push(0.01), min_interval < 0.01);
  }
}

TEST(DeviceOptions, DelayOfTheJitterBufferIsLimited) {
  for (const double max_delay : {0.02, 0.06}) {
    JitterBuffer buffer(max_delay, 0.05);
    for (int i = 0; i < 64; ++i) {  // every other sample is late by 40 ms
      RemoteSample sample;
      sample.sender_clock = 0.05 * i;
      sample.arrival = sample.sender_clock + (i % 2 == 0 ? 0.0 : 0.04);
      buffer.add(sample);
    }
    EXPECT_NEAR(buffer.delay(), max_delay, 1e-9);
  }
}

TEST(DeviceOptions, RejectADelayThatTheBufferDoesNotCover) {
  RemoteDeviceOptions options;
  EXPECT_FALSE(section_of(options).check());
  options.max_delay = 0.2;
  EXPECT_TRUE(section_of(options).check());
  EXPECT_THROW(RemoteDevice{options}, ContractError);
  options.min_interval = 0.008;
  EXPECT_FALSE(section_of(options).check());
  EXPECT_NO_THROW(RemoteDevice{options});
}

TEST(DeviceOptions, SimulatedHandSwaysByItsAmplitude) {
  DeviceOptions options;
  options.simulated.sway = 0.02;
  options.simulated.sway_period = 1.0;
  options.simulated.force_noise = 0.0;
  options.simulated.hand_stiffness = 1e5;
  const auto device = open_device("simulated", options);
  ASSERT_TRUE(device);
  double max_x = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const DeviceSample sample = (*device)->exchange(kOptionCycle * i, kOptionCycle, {});
    max_x = std::max(max_x, sample.p_base_tip.x());
  }
  EXPECT_NEAR(max_x, 0.02, 1e-3);
}

}  // namespace
}  // namespace pcavr
