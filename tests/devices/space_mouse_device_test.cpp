// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/devices/space_mouse_device.hpp"

#include <gtest/gtest.h>

#include "devices/comes_to.hpp"
#include "devices/fake_spacenavd.hpp"

namespace pcavr {
namespace {

using test::comes_to_be;
using test::comes_to_move_by;
using test::comes_to_stop;
using test::FakeSpacenavd;

TEST(SpaceMouseDevice, TheCapMovesTheTipWhileTheLeftButtonIsHeld) {
  FakeSpacenavd daemon;
  RateOptions rate;
  rate.max_speed = 0.1;
  auto device = SpaceMouseDevice::open({}, rate);
  ASSERT_TRUE(device) << device.error().to_string();
  EXPECT_EQ((*device)->name(), "SpaceMouse (FakeNavigator)");
  ASSERT_TRUE(comes_to_be(**device, true, false));
  daemon.motion(0, 0, 175);
  daemon.button(1, true);
  ASSERT_TRUE(comes_to_be(**device, true, false));
  daemon.button(0, true);
  EXPECT_TRUE(comes_to_move_by(**device, {0.05, 0.0, 0.0})) << "away";
  daemon.motion(350, 0, 0);
  EXPECT_TRUE(comes_to_move_by(**device, {0.0, -0.1, 0.0})) << "to the right";
  daemon.motion(0, -350, 0);
  EXPECT_TRUE(comes_to_move_by(**device, {0.0, 0.0, -0.1})) << "down";
  daemon.motion(0, 1 << 30, 0);
  EXPECT_TRUE(comes_to_move_by(**device, {0.0, 0.0, 0.1})) << "bounded";
  daemon.button(0, false);
  EXPECT_TRUE(comes_to_be(**device, true, false));
}

TEST(SpaceMouseDevice, TheRightButtonIsTheEmergencyStop) {
  FakeSpacenavd daemon;
  auto device = SpaceMouseDevice::open();
  ASSERT_TRUE(device) << device.error().to_string();
  daemon.button(0, true);
  ASSERT_TRUE(comes_to_be(**device, true, true));
  EXPECT_FALSE((*device)->exchange(0.0, test::kCycle, test::kPushed).is_stop_pressed);
  daemon.button(1, true);
  ASSERT_TRUE(comes_to_stop(**device));
  EXPECT_TRUE((*device)->exchange(0.0, test::kCycle, test::kPushed).is_stop_pressed) << "held";
  daemon.unplug();
  EXPECT_TRUE(comes_to_stop(**device, false));
  daemon.plug_in();
  ASSERT_TRUE(comes_to_be(**device, true, false));
  // Pressed and released before the next exchange: the clutch shows that both have been read.
  daemon.button(1, true);
  daemon.button(1, false);
  daemon.button(0, true);
  DeviceSample sample;
  bool is_stopped = false;
  EXPECT_TRUE(test::eventually([&] {
    sample = (*device)->exchange(0.0, test::kCycle, test::kPushed);
    is_stopped = is_stopped || sample.is_stop_pressed;
    return sample.is_engaged;
  }));
  EXPECT_TRUE(is_stopped);
}

TEST(SpaceMouseDevice, AnotherButtonCanBeTheEmergencyStop) {
  FakeSpacenavd daemon;
  SpaceMouseOptions options;
  options.stop_button = 7;
  auto device = SpaceMouseDevice::open(options);
  ASSERT_TRUE(device) << device.error().to_string();
  daemon.button(1, true);
  daemon.button(0, true);
  ASSERT_TRUE(comes_to_be(**device, true, true));
  EXPECT_FALSE((*device)->exchange(0.0, test::kCycle, test::kPushed).is_stop_pressed);
  daemon.button(7, true);
  EXPECT_TRUE(comes_to_stop(**device));
}

TEST(SpaceMouseDevice, MovesInTheOperatorsFrame) {
  FakeSpacenavd daemon;
  RateOptions rate;
  rate.max_speed = 0.1;
  rate.facing = M_PI / 2.0;
  auto device = SpaceMouseDevice::open({}, rate);
  ASSERT_TRUE(device) << device.error().to_string();
  daemon.motion(0, 0, 350);
  daemon.button(0, true);
  EXPECT_TRUE(comes_to_move_by(**device, {0.0, 0.1, 0.0}));
}

TEST(SpaceMouseDevice, IsAbsentWhileUnplugged) {
  FakeSpacenavd daemon;
  auto device = SpaceMouseDevice::open();
  ASSERT_TRUE(device) << device.error().to_string();
  daemon.button(0, true);
  ASSERT_TRUE(comes_to_be(**device, true, true));
  daemon.unplug();
  EXPECT_TRUE(comes_to_be(**device, false, false));
  daemon.plug_in();
  EXPECT_TRUE(comes_to_be(**device, true, false));
}

TEST(SpaceMouseDevice, IsAbsentOnceItsDaemonEnds) {
  FakeSpacenavd daemon;
  auto device = SpaceMouseDevice::open();
  ASSERT_TRUE(device) << device.error().to_string();
  daemon.button(0, true);
  ASSERT_TRUE(comes_to_be(**device, true, true));
  daemon.end();
  EXPECT_TRUE(comes_to_be(**device, false, false));
}

TEST(SpaceMouseDevice, IgnoresUnknownPackets) {
  FakeSpacenavd daemon;
  auto device = SpaceMouseDevice::open();
  ASSERT_TRUE(device) << device.error().to_string();
  daemon.send({99, -1, -1, -1, -1, -1, -1, -1});
  daemon.send({-7});
  daemon.button(0, true);
  EXPECT_TRUE(comes_to_be(**device, true, true));
}

TEST(SpaceMouseDevice, ReportsIfItIsAlreadyOpen) {
  FakeSpacenavd daemon;
  auto device = SpaceMouseDevice::open();
  ASSERT_TRUE(device) << device.error().to_string();
  const auto second = SpaceMouseDevice::open();
  ASSERT_FALSE(second);
  EXPECT_NE(second.error().message.find("already open"), std::string::npos);
}

TEST(SpaceMouseDevice, ReportsIfNothingIsConnected) {
  FakeSpacenavd daemon(false);
  const auto device = SpaceMouseDevice::open();
  ASSERT_FALSE(device);
  EXPECT_NE(device.error().message.find("reports no device"), std::string::npos);
  EXPECT_EQ(device.error().hint, "plug it in");
}

TEST(SpaceMouseDevice, CanBeReopened) {
  FakeSpacenavd daemon;
  for (int i = 0; i < 3; ++i) {
    auto device = SpaceMouseDevice::open();
    ASSERT_TRUE(device) << device.error().to_string();
    EXPECT_TRUE(comes_to_be(**device, true, false));
  }
}

}  // namespace
}  // namespace pcavr
