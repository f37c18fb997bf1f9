// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/rosbag/ros_definitions.hpp"

#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include "pcavr/recordings/rosbag/ros_messages.hpp"

namespace pcavr {
namespace {

// A viewer can decode nothing of a message whose definition lacks that of a part.
TEST(RosDefinitions, HaveEachTypeThatTheyUse) {
  for (const char* const type :
       {"geometry_msgs/msg/PoseStamped", "geometry_msgs/msg/WrenchStamped",
        "tf2_msgs/msg/TFMessage", "sensor_msgs/msg/JointState", "sensor_msgs/msg/CameraInfo",
        "sensor_msgs/msg/CompressedImage", "sensor_msgs/msg/Image",
        "geometry_msgs/msg/PointStamped", "geometry_msgs/msg/PoseWithCovarianceStamped",
        "geometry_msgs/msg/TransformStamped", "nav_msgs/msg/Odometry"}) {
    EXPECT_NE(ros_message_kind(type), RosMessageKind::other) << type;
    const std::string definition = ros_message_definition(type);
    EXPECT_FALSE(definition.empty()) << type;
    std::set<std::string> used, defined;
    std::istringstream lines(definition);
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("MSG: ")) {
        defined.insert(line.substr(5));
      } else if (const std::size_t slash = line.find('/'); slash != std::string::npos) {
        used.insert(line.substr(0, line.find_first_of(" [")));
      }
    }
    EXPECT_EQ(used, defined) << type;
  }
}

TEST(RosDefinitions, AreEmptyForOtherTypes) {
  EXPECT_EQ(ros_message_definition("std_msgs/msg/String"), "");
}

}  // namespace
}  // namespace pcavr
