// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/teleoperation/ros2/ros2_setup.hpp"
#include "pcavr/teleoperation/sites/robot_interface.hpp"
#include "pcavr/teleoperation/teleop/run_teleop.hpp"

namespace pcavr {

/// Opens the transport for these topics: open_dds, or a test's.
using Ros2Opener = std::function<Expected<std::unique_ptr<Ros2Transport>>(
    const std::vector<Ros2Topic>& subscribed, const std::vector<Ros2Topic>& published,
    const DdsOptions& options)>;

/// A robot behind topics of ROS 2 [docs/ros2.md]. Waits for the tool's first pose, at most
/// `setup.start_timeout`; its orientation is kept in all commands. An Error without it, and for an
/// object that `world` does not have. Messages are read by a thread of its own and handed to
/// advance() without locks; another one publishes the newest setpoint, as long as the site gives
/// new ones, the tool's poses arrive, and the setpoint is near the tool.
[[nodiscard]] Expected<std::unique_ptr<RobotInterface>> make_ros2_robot(
    const Ros2Setup& setup, const TeleopInput& world, const Ros2Opener& open = open_dds);

}  // namespace pcavr
