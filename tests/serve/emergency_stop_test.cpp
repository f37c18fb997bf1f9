// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/serve/live_protocol.hpp"
#include "pcavr/serve/operator_page.hpp"

#include "serve/live_cycle_fixture.hpp"
#include "serve/server_message_reader.hpp"

namespace pcavr {
namespace {

using EmergencyStop = test::LiveCycleTest;
using test::kCycle;
using test::kInTheBox;

/// [m] in which friction alone stops the box.
double coasting_distance(double speed) {
  const auto friction = test::foam_physics().friction;
  return speed * speed * friction.mass / (2.0 * friction.coulomb_force);
}

// Only friction acts on the box from the stop on. Only the release ends it, and then the clutch has
// to open first.
TEST_F(EmergencyStop, AnEmergencyStopDisengagesTheToolUntilItsRelease) {
  move(kInTheBox, 1500);
  cycle_.emergency_stop();
  const WorldSnapshot& at_stop = run(1);
  const double box = at_stop.world.bodies[0].T_base_object.translation().x();
  const double speed = at_stop.speeds[0];
  EXPECT_NEAR(speed, 0.2, 0.02);  // with the hand
  double max_tool_force = 0.0;
  for (int i = 1; i <= 500; ++i) {
    sample_.p_base_tip.x() = kInTheBox.x() + 4e-4 * i;
    max_tool_force = std::max(max_tool_force, run(1).world.bodies[0].tool_force_base.norm());
  }
  const WorldSnapshot& stopped = cycle_.newest();
  EXPECT_TRUE(stopped.is_stopped);
  EXPECT_FALSE(stopped.world.is_engaged);
  EXPECT_TRUE(stopped.world.force_base.isZero(1e-9));
  EXPECT_EQ(max_tool_force, 0.0);
  EXPECT_EQ(stopped.speeds[0], 0.0);
  EXPECT_NEAR(stopped.world.bodies[0].T_base_object.translation().x() - box,
              coasting_distance(speed), 2e-4);
  cycle_.hold(false);  // a resume is no release
  EXPECT_TRUE(run(10).is_stopped);
  cycle_.release_emergency_stop();
  EXPECT_FALSE(run(10).is_stopped);
  EXPECT_TRUE(run(1).is_on_hold);
  cycle_.hold(false);
  EXPECT_FALSE(run(10).world.is_engaged);
  sample_.is_engaged = false;
  run(10);
  sample_.is_engaged = true;
  EXPECT_TRUE(run(10).world.is_engaged);
}

TEST_F(EmergencyStop, TheDevicesButtonStopsUntilAPageReleasesIt) {
  move(kInTheBox, 1500);
  sample_.is_stop_pressed = true;
  EXPECT_TRUE(run(1).is_stopped);
  EXPECT_FALSE(cycle_.newest().world.is_engaged);
  EXPECT_TRUE(run(100).world.force_base.isZero(1e-9));
  cycle_.release_emergency_stop();
  EXPECT_TRUE(run(1).is_stopped) << "the button is held";
  sample_.is_stop_pressed = false;
  EXPECT_TRUE(run(100).is_stopped);
  cycle_.release_emergency_stop();
  EXPECT_FALSE(run(1).is_stopped);
}

TEST(OperatorPageStop, TheDevicesButtonIsOneRequestToTheRobotsSite) {
  DeviceSample sample{test::kToolStart, Eigen::Quaterniond::Identity(), false, true};
  HapticWorldModel model = test::one_box_on_a_table();
  const std::string box = model.world.bodies.front().model.name;
  auto page =
      OperatorPage::create(std::move(model), {box}, std::make_unique<test::ScriptedDevice>(sample),
                           test::options_with_tool_start(), MotionLimits());
  ASSERT_TRUE(page) << page.error().to_string();
  OperatorLink link;
  const auto requests = [&] {
    link.now += 2.0 * kCycle;
    (*page)->wait(link);
    return (*page)->take_requests();
  };
  link.now = 1.0;
  EXPECT_FALSE(requests().is_stopped);
  sample.is_stop_pressed = true;
  EXPECT_EQ(requests().is_stopped, true);
  EXPECT_FALSE(requests().is_stopped) << "asked for once";
  EXPECT_TRUE((*page)->newest().is_stopped);
  sample.is_stop_pressed = false;
  EXPECT_FALSE(requests().is_stopped);
  sample.is_stop_pressed = true;
  EXPECT_EQ(requests().is_stopped, true);
}

// A robot with these limits can follow it.
TEST_F(EmergencyStop, ALimitedToolBrakesWhenTheClutchOpens) {
  cycle_.limit_motion(MotionLimits());
  move(test::kToolStart + Eigen::Vector3d(0.0, 0.2, 0.3), 1000);
  Eigen::Vector3d before = run(1).world.p_base_hip;
  Eigen::Vector3d v_before = (run(1).world.p_base_hip - before) / kCycle;
  EXPECT_GT(v_before.norm(), 0.05);
  sample_.is_engaged = false;
  before = cycle_.newest().world.p_base_hip;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d p = run(1).world.p_base_hip;
    const Eigen::Vector3d v = (p - before) / kCycle;
    EXPECT_LE((v - v_before).cwiseAbs().maxCoeff(),
              MotionLimits().max_acceleration * kCycle * 1.01);
    before = p;
    v_before = v;
  }
  EXPECT_TRUE(v_before.isZero(1e-9));
  EXPECT_FALSE(cycle_.newest().world.is_engaged);
}

TEST(LinkState, ALinkSurvivesARoundTripWithAndWithoutAnArm) {
  LiveState state;
  state.page_clock = 1.0;
  state.is_stopped = true;
  state.objects.resize(2);
  LiveLinkState link{true,
                     0.5F,
                     0.25F,
                     0.4F,
                     1e-4F,
                     LiveLinkState::Robot{},
                     DelayStamps{{}, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0}};
  link.robot->is_stopped = true;
  link.robot->limits = 5;
  link.robot->objects.resize(2);
  link.robot->objects[1].is_tracked = true;
  link.robot->objects[1].age = 0.125F;
  for (const bool has_arm : {false, true}) {
    state.arm.reset();
    if (has_arm) state.arm = LiveArmState{{0.5F, -1.0F}, false, true, {}};
    state.link = link;
    const auto bytes = encode(ServerMessage{{5, 2.0}, state});
    const auto read = decode_server_message(bytes);
    ASSERT_TRUE(read) << read.error().to_string();
    const auto& same = std::get<LiveState>(read->content);
    EXPECT_EQ(encode(*read), bytes);
    EXPECT_EQ(same.arm.has_value(), has_arm);
    ASSERT_TRUE(same.link && same.link->robot && same.link->delays);
    EXPECT_TRUE(same.is_stopped);
    EXPECT_TRUE(same.link->robot->is_stopped);
    EXPECT_FALSE(same.link->robot->is_on_hold);
    EXPECT_EQ(same.link->robot->objects[1].age, 0.125F);
    EXPECT_FALSE(same.link->delays->device_clock);
    EXPECT_EQ(same.link->delays->received_back, 7.0);
    for (std::size_t length = 24; !has_arm && length < bytes.size(); ++length) {
      auto cut =
          std::vector<std::uint8_t>(bytes.begin(), bytes.begin() + static_cast<long>(length));
      cut[12] = static_cast<std::uint8_t>(length - 24);
      cut[13] = static_cast<std::uint8_t>((length - 24) >> 8U);
      EXPECT_FALSE(decode_server_message(cut)) << length;
    }
  }
}

}  // namespace
}  // namespace pcavr
