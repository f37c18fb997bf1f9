// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/devices/gamepad_device.hpp"

#include <atomic>
#include <cstdlib>

#include <gtest/gtest.h>

#define SDL_MAIN_HANDLED
#include <SDL.h>

#include "devices/eventually.hpp"

namespace pcavr {
namespace {

using test::eventually;

constexpr double kCycle = 0.001;  // [s]
const DeviceFeedback kFeedback{
    .p_base_tool = {0.5, 0.1, 0.2}, .force_base = {0.0, 0.0, 2.5}, .pulse = 1.0};

/// A gamepad that SDL makes up, with motors that say how they run.
class VirtualGamepad {
 public:
  VirtualGamepad() {
    SDL_SetHint(SDL_HINT_JOYSTICK_ALLOW_BACKGROUND_EVENTS, "1");
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
    SDL_InitSubSystem(SDL_INIT_GAMECONTROLLER);
    SDL_VirtualJoystickDesc description{};
    description.version = SDL_VIRTUAL_JOYSTICK_DESC_VERSION;
    description.type = SDL_JOYSTICK_TYPE_GAMECONTROLLER;
    description.naxes = SDL_CONTROLLER_AXIS_MAX;
    description.nbuttons = SDL_CONTROLLER_BUTTON_MAX;
    description.name = "Virtual Pad";
    description.userdata = this;
    description.Rumble = [](void* pad, Uint16 low, Uint16 high) {
      static_cast<VirtualGamepad*>(pad)->heavy = low;
      static_cast<VirtualGamepad*>(pad)->light = high;
      return 0;
    };
    index_ = SDL_JoystickAttachVirtualEx(&description);
    joystick_ = SDL_JoystickOpen(index_);
  }
  ~VirtualGamepad() {
    unplug();
    SDL_JoystickClose(joystick_);
    SDL_QuitSubSystem(SDL_INIT_GAMECONTROLLER);
  }
  VirtualGamepad(const VirtualGamepad&) = delete;
  VirtualGamepad& operator=(const VirtualGamepad&) = delete;

  void axis(SDL_GameControllerAxis which, int value) {
    SDL_JoystickSetVirtualAxis(joystick_, which, static_cast<Sint16>(value));
  }
  void button(SDL_GameControllerButton which, bool is_down) {
    SDL_JoystickSetVirtualButton(joystick_, which, is_down ? 1 : 0);
  }
  void unplug() {
    if (index_ >= 0) SDL_JoystickDetachVirtual(index_);
    index_ = -1;
  }

  std::atomic<int> heavy{0};
  std::atomic<int> light{0};

 private:
  int index_ = -1;
  SDL_Joystick* joystick_ = nullptr;
};

bool comes_to_be(Device& device, bool is_present, bool is_engaged) {
  return eventually([&] {
    const DeviceSample said = device.exchange(0.0, kCycle, kFeedback);
    return said.is_present == is_present && said.is_engaged == is_engaged;
  });
}

bool comes_to_move_by(Device& device, const Eigen::Vector3d& v) {
  DeviceFeedback feedback = kFeedback;
  Eigen::Vector3d before = feedback.p_base_tool;
  return eventually([&] {
    const DeviceSample said = device.exchange(0.0, kCycle, feedback);
    feedback.p_base_tool = said.p_base_tip;
    const Eigen::Vector3d moved = said.p_base_tip - before;
    before = said.p_base_tip;
    return said.is_engaged && (moved / kCycle - v).norm() < 1e-9;
  });
}

TEST(GamepadDevice, MovesTheTipAsTheSticksArePushedWhileTheShoulderIsHeld) {
  VirtualGamepad pad;
  auto device = GamepadDevice::open({.rate = {.most_speed = 0.1}});
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

TEST(GamepadDevice, ShakesWithTheForceAndThePulseWhileEngaged) {
  VirtualGamepad pad;
  auto device = GamepadDevice::open();
  ASSERT_TRUE(device) << device.error().to_string();
  ASSERT_TRUE(comes_to_be(**device, true, false));
  EXPECT_EQ(pad.heavy, 0);
  pad.button(SDL_CONTROLLER_BUTTON_RIGHTSHOULDER, true);
  // 2.5 of 5 N, and a pulse of 1.
  EXPECT_TRUE(eventually([&] {
    (void)(*device)->exchange(0.0, kCycle, kFeedback);
    return pad.heavy == 32768 && pad.light == 65535;
  })) << pad.heavy;
  pad.button(SDL_CONTROLLER_BUTTON_RIGHTSHOULDER, false);
  EXPECT_TRUE(eventually([&] {
    (void)(*device)->exchange(0.0, kCycle, kFeedback);
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

TEST(GamepadDevice, SaysWhenThereIsNone) {
  const auto device = GamepadDevice::open();
  if (device) GTEST_SKIP() << "a real gamepad is plugged in";
  EXPECT_NE(device.error().message.find("no gamepad"), std::string::npos);
  EXPECT_FALSE(device.error().mend.empty());
}

}  // namespace
}  // namespace pcavr
