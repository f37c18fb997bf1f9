// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "pcavr/recordings/rosbag/cdr_messages.hpp"
#include "pcavr/teleoperation/ros2/ros2_transport.hpp"

#include "ros2/ros2_peer.hpp"
#include "support/forked.hpp"
#include "support/read_bag.hpp"

namespace pcavr::test {

inline std::int64_t realtime() {
  timespec now{};
  ::clock_gettime(CLOCK_REALTIME, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

inline const Ros2Topic kToolTopic{"/tool_pose", "geometry_msgs/msg/PoseStamped", {.depth = 10}};
inline const Ros2Topic kWrenchTopic{"/wrench", "geometry_msgs/msg/WrenchStamped", {.depth = 10}};

/// A robot in a process of its own that publishes poses and wrenches at some 500 Hz over DDS on
/// loopback until it is killed: a tip that goes back and forth. To be made before any participant
/// of this process.
class PublishingRobot {
 public:
  PublishingRobot()
      : process_([dds = loopback_options()] {
          auto topics = open_dds({}, {kToolTopic, kWrenchTopic}, dds);
          ForkedProcess::report_ready();
          for (int i = 0; topics; ++i) {
            const Stamp stamp{realtime()};
            const double x = 0.4 + 0.0001 * std::abs(i % 2000 - 1000);
            const Pose T_base_tool = Pose::from_translation({x, 0.0, 0.1});
            (void)(*topics)->publish(0, cdr::pose_stamped(stamp, T_base_tool, "base_link"));
            (void)(*topics)->publish(
                1, cdr::wrench_stamped(stamp, {0, 0, 0.1}, {0, 0, 0}, "base_link"));
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
          }
        }) {}

 private:
  ForkedProcess process_;
};

/// The robot's ros2.yaml in a folder.
inline std::string write_ros2_setup(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "ros2.yaml";
  std::ofstream(file) << "format: pcavr-ros2/1\ndomain: " << loopback_options().domain << R"(
network: {interface: 127.0.0.1, peers: [127.0.0.1], multicast: false}
tool: {topic: /tool_pose}
wrench: {topic: /wrench}
)";
  return file.string();
}

}  // namespace pcavr::test
