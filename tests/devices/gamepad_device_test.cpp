// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/devices/gamepad_device.hpp"

#include <gtest/gtest.h>

#include "pcavr/base/core/options.hpp"

#include "devices/comes_to.hpp"
#include "devices/virtual_gamepad.hpp"

namespace pcavr {
namespace {

using test::comes_to_be;
using test::comes_to_move_by;
using test::comes_to_stop;
using test::eventually;
using test::kCycle;
using test::kPushed;
using test::VirtualGamepad;

TEST(GamepadDevice, SticksMoveTheTipWhileTheShoulderIsHeld) {
  VirtualGamepad pad;
  RateOptions rate;
  rate.max_speed = 0.1;
  auto device = GamepadDevice::open({}, rate);
  ASSERT_TRUE(device) << device.error().to_string();
  EXPECT_EQ((*device)->name(), "gamepad (Virtual Pad)");
  pad.axis(SDL_CONTROLLER_AXIS_LEFTY, -32768);
  ASSERT_TRUE(comes_to_be(**device, true, false));
  pad.button(SDL_CONTROLLER_BUTTON_RIGHTSHOULDER, true);
  EXPECT_TRUE(comes_to_move_by(**device, {0.1, 0.0, 0.0})) << "away";
  pad.axis(SDL_CONTROLLER_AXIS_LEFTY, 0);
  pad.axis(SDL_CONTROLLER_AXIS_LEFTX, 32767);
  EXPECT_TRUE(comes_to_move_by(**device, {0.0, -0.1, 0.0})) << "to the right";
  pad.axis(SDL_CONTROLLER_AXIS_LEFTX, 7000);
  EXPECT_TRUE(comes_to_move_by(**device, Eigen::Vector3d::Zero())) << "a worn stick at rest";
  pad.axis(SDL_CONTROLLER_AXIS_RIGHTY, 32767);
  EXPECT_TRUE(comes_to_move_by(**device, {0.0, 0.0, -0.1})) << "down";
}

TEST(GamepadDevice, IsEngagedByTheTriggerToo) {
  VirtualGamepad pad;
  auto device = GamepadDevice::open();
  ASSERT_TRUE(device) << device.error().to_string();
  pad.axis(SDL_CONTROLLER_AXIS_TRIGGERRIGHT, -32768);
  ASSERT_TRUE(comes_to_be(**device, true, false));
  pad.axis(SDL_CONTROLLER_AXIS_TRIGGERRIGHT, 32767);
  EXPECT_TRUE(comes_to_be(**device, true, true));
}

TEST(GamepadDevice, TheRightFaceButtonIsTheEmergencyStop) {
  VirtualGamepad pad;
  auto device = GamepadDevice::open();
  ASSERT_TRUE(device) << device.error().to_string();
  pad.button(SDL_CONTROLLER_BUTTON_A, true);
  pad.button(SDL_CONTROLLER_BUTTON_RIGHTSHOULDER, true);
  ASSERT_TRUE(comes_to_be(**device, true, true));
  EXPECT_FALSE((*device)->exchange(0.0, kCycle, kPushed).is_stop_pressed);
  pad.button(SDL_CONTROLLER_BUTTON_B, true);
  EXPECT_TRUE(comes_to_stop(**device));
  pad.button(SDL_CONTROLLER_BUTTON_B, false);
  EXPECT_TRUE(comes_to_stop(**device, false));
}

TEST(GamepadDevice, AnotherButtonCanBeTheEmergencyStop) {
  VirtualGamepad pad;
  GamepadOptions options;
  options.stop_button = SDL_CONTROLLER_BUTTON_Y;
  auto device = GamepadDevice::open(options);
  ASSERT_TRUE(device) << device.error().to_string();
  pad.button(SDL_CONTROLLER_BUTTON_Y, true);
  EXPECT_TRUE(comes_to_stop(**device));
  options.stop_button = SDL_CONTROLLER_BUTTON_RIGHTSHOULDER;
  EXPECT_TRUE(section_of(options).check()) << "the clutch's";
}

TEST(GamepadDevice, VibratesByForceAndPulseWhileEngaged) {
  VirtualGamepad pad;
  auto device = GamepadDevice::open();
  ASSERT_TRUE(device) << device.error().to_string();
  ASSERT_TRUE(comes_to_be(**device, true, false));
  EXPECT_EQ(pad.heavy, 0);
  pad.button(SDL_CONTROLLER_BUTTON_RIGHTSHOULDER, true);
  // 2.5 of 5 N, and a pulse of 1.
  EXPECT_TRUE(eventually([&] {
    (void)(*device)->exchange(0.0, kCycle, kPushed);
    return pad.heavy == 32768 && pad.light == 65535;
  })) << pad.heavy;
  pad.button(SDL_CONTROLLER_BUTTON_RIGHTSHOULDER, false);
  EXPECT_TRUE(eventually([&] {
    (void)(*device)->exchange(0.0, kCycle, kPushed);
    return pad.heavy == 0 && pad.light == 0;
  }));
}

TEST(GamepadDevice, IsAbsentWhileUnpluggedAndFindsTheNextOne) {
  auto pad = std::make_unique<VirtualGamepad>();
  auto device = GamepadDevice::open();
  ASSERT_TRUE(device) << device.error().to_string();
  pad->button(SDL_CONTROLLER_BUTTON_RIGHTSHOULDER, true);
  ASSERT_TRUE(comes_to_be(**device, true, true));
  pad->unplug();
  EXPECT_TRUE(comes_to_be(**device, false, false));
  VirtualGamepad next;
  EXPECT_TRUE(comes_to_be(**device, true, false));
}

TEST(GamepadDevice, ReportsIfThereIsNone) {
  const auto device = GamepadDevice::open();
  if (device) GTEST_SKIP() << "a real gamepad is plugged in";
  EXPECT_NE(device.error().message.find("no gamepad"), std::string::npos);
  EXPECT_FALSE(device.error().hint.empty());
}

}  // namespace
}  // namespace pcavr
