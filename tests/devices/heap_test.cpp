// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
//
// No device's exchange allocates. The counter is that of the whole process.
#include <gtest/gtest.h>

#include "pcavr/teleoperation/devices/gamepad_device.hpp"
#include "pcavr/teleoperation/devices/plugin_device.hpp"
#include "pcavr/teleoperation/devices/simulated_force_device.hpp"
#include "pcavr/teleoperation/devices/space_mouse_device.hpp"
#include "pcavr/teleoperation/devices/trace_device.hpp"

#include "devices/eventually.hpp"
#include "devices/fake_spacenavd.hpp"
#include "devices/jittered_hand.hpp"
#include "devices/virtual_gamepad.hpp"
#include "support/heap_counter.hpp"

namespace pcavr {
namespace {

using test::kCycle;

/// Number of heap allocations over 2 s of cycles, after the device has engaged.
long allocations_of(Device& device) {
  DeviceFeedback feedback{.force_base = {1.0, 0.0, -2.0}, .pulse = 0.5};
  EXPECT_TRUE(test::eventually([&] { return device.exchange(0.0, kCycle, feedback).is_engaged; }));
  const long before = heap_allocations;
  for (int i = 0; i < 2000; ++i) {
    feedback.p_base_tool = device.exchange(i * kCycle, kCycle, feedback).p_base_tip;
  }
  return heap_allocations - before;
}

TEST(Heap, IsNotUsedByARemoteDevice) {
  RemoteDevice device;
  const std::vector<RemoteSample> samples = test::sent_over({}, 2.0, 7);
  const long before = heap_allocations;
  test::run(device, samples, 1.0, {}, [](double, const DeviceSample&) {});
  device.release();
  test::run(device, samples, 3.0, {}, [](double, const DeviceSample&) {});
  EXPECT_EQ(heap_allocations, before);
}

TEST(Heap, IsNotUsedByATrace) {
  TraceDevice device({{.t = 0.0}, {.t = 0.5, .p_base_tip = {0.1, 0.0, 0.0}}, {.t = 1.0}});
  EXPECT_EQ(allocations_of(device), 0);
}

TEST(Heap, IsNotUsedByASimulatedForceDevice) {
  SimulatedForceDevice device;
  EXPECT_EQ(allocations_of(device), 0);
}

TEST(Heap, IsNotUsedByAPlugin) {
  auto device = PluginDevice::open(std::string(PCAVR_FAULTY_PLUGINS) + "answers.so");
  ASSERT_TRUE(device) << device.error().to_string();
  EXPECT_EQ(allocations_of(**device), 0);
}

TEST(Heap, IsNotUsedByASpaceMouse) {
  test::FakeSpacenavd daemon;
  auto device = SpaceMouseDevice::open();
  ASSERT_TRUE(device) << device.error().to_string();
  daemon.motion(1, 2, 3);
  daemon.button(0, true);
  EXPECT_EQ(allocations_of(**device), 0);
}

TEST(Heap, IsNotUsedByAGamepad) {
  test::VirtualGamepad pad;
  auto device = GamepadDevice::open();
  ASSERT_TRUE(device) << device.error().to_string();
  pad.button(SDL_CONTROLLER_BUTTON_RIGHTSHOULDER, true);
  EXPECT_EQ(allocations_of(**device), 0);
}

}  // namespace
}  // namespace pcavr
