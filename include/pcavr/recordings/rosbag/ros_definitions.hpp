// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace pcavr {

/// The definition of a ROS 2 message type as bags state it (schema encoding "ros2msg"), of the
/// types with a header or transforms that ros_message_kind() knows; empty for any other. `type` as
/// in "geometry_msgs/msg/PoseStamped". Pure function.
[[nodiscard]] std::string ros_message_definition(std::string_view type);

}  // namespace pcavr
