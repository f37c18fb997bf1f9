// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
//
// A robot that publishes its joint states by DDS, in another process.
#include <chrono>
#include <cmath>
#include <thread>

#include <gtest/gtest.h>

#include "pcavr/teleoperation/ros2/ros2_robot.hpp"

#include "ros2/planar_arm.hpp"
#include "ros2/ros2_peer.hpp"
#include "support/forked.hpp"
#include "support/ros_encoder.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

using namespace std::chrono_literals;

constexpr double kElbow = 0.5;  // [rad]

/// Tip of the planar arm, on its pedestal [m].
Eigen::Vector3d p_base_tip(double shoulder) {
  return {0.4 * std::cos(shoulder) + 0.3 * std::cos(shoulder + kElbow),
          0.4 * std::sin(shoulder) + 0.3 * std::sin(shoulder + kElbow), 0.0};
}

/// Turns the shoulder by 1 mrad a message, in both directions, from 0.
void publish_joint_states(Ros2Transport& transport) {
  for (int i = 0;; ++i) {
    timespec now{};
    ::clock_gettime(CLOCK_REALTIME, &now);
    const double shoulder = 1e-3 * std::abs(i % 1000 - 500);
    RosEncoder encoder(RosEncoder::Format::cdr);
    encoder.header(Stamp{now.tv_sec * 1'000'000'000 + now.tv_nsec}, "").number(std::uint32_t{3});
    for (const char* const name : {"grip", "elbow", "shoulder"}) encoder.text(name);
    const std::string text =
        encoder.doubles({0.01, kElbow, shoulder}).doubles({}).doubles({}).bytes();
    (void)transport.publish(0, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
    std::this_thread::sleep_for(2ms);
  }
}

TEST(JointStates, MoveTheToolOverDds) {
  const TemporaryFolder folder;
  Ros2Setup setup = planar_arm_setup(folder.path());
  setup.dds = loopback_options();
  setup.dds.domain += 20;  // no other test's
  setup.start_timeout = 20.0;
  const ForkedProcess peer([&] {
    auto transport = open_dds({}, {setup.tool}, setup.dds);
    ForkedProcess::report_ready();
    if (transport) publish_joint_states(**transport);
  });
  const auto robot = make_ros2_robot(setup, TeleopInput());
  ASSERT_TRUE(robot) << robot.error().to_string();
  RobotSamples samples;
  for (int i = 1; i <= 1000 && samples.tool.size() < 300; ++i) {
    std::this_thread::sleep_for(2ms);
    (*robot)->advance(0.002 * i, samples);
  }
  ASSERT_GE(samples.tool.size(), 300U);
  double lowest = 10.0, highest = -10.0;
  for (const RobotSamples::Tool& tool : samples.tool) {
    const Eigen::Vector3d& p = tool.p_base_tip;
    // The pose is on the circle of the tip, whatever the shoulder's angle is.
    EXPECT_NEAR(p.norm(), p_base_tip(0.0).norm(), 1e-9);
    const double shoulder =
        std::atan2(p.y(), p.x()) - std::atan2(p_base_tip(0.0).y(), p_base_tip(0.0).x());
    EXPECT_NEAR(shoulder, 1e-3 * std::round(1e3 * shoulder), 1e-9);
    EXPECT_LT((p - p_base_tip(shoulder)).norm(), 1e-9);
    lowest = std::min(lowest, shoulder);
    highest = std::max(highest, shoulder);
  }
  EXPECT_GT(highest - lowest, 0.2);
  EXPECT_TRUE((*robot)->take_notices().empty());
}

}  // namespace
}  // namespace pcavr
