// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "pcavr/recordings/rosbag/ros_messages.hpp"
#include "pcavr/teleoperation/record/recorder.hpp"

namespace pcavr {
namespace {

// While the reading thread waits for the processor: a second of a fast sensor, a third of a second
// of a camera.
constexpr int kMessageDepth = 1000;
constexpr int kImageDepth = 10;

bool is_image(RosMessageKind kind) {
  return kind == RosMessageKind::image || kind == RosMessageKind::compressed_image;
}

}  // namespace

RecordRole role_of_type(const std::string& type) {
  const RosMessageKind kind = ros_message_kind(type);
  if (is_image(kind)) return RecordRole::image;
  switch (kind) {
    case RosMessageKind::wrench:
      return RecordRole::wrench;
    case RosMessageKind::transforms:
      return RecordRole::transforms;
    case RosMessageKind::camera_info:
      return RecordRole::camera_info;
    case RosMessageKind::pose:
    case RosMessageKind::point:
    case RosMessageKind::transform:
      return RecordRole::object;
    default:
      return RecordRole::other;
  }
}

RecordRole role_of(Ros2Subscription::Role role) {
  switch (role) {
    case Ros2Subscription::Role::tool:
      return RecordRole::tool;
    case Ros2Subscription::Role::wrench:
      return RecordRole::wrench;
    case Ros2Subscription::Role::transforms:
      return RecordRole::transforms;
    case Ros2Subscription::Role::object:
      return RecordRole::object;
    case Ros2Subscription::Role::image:
      return RecordRole::image;
    case Ros2Subscription::Role::camera_info:
      return RecordRole::camera_info;
  }
  return RecordRole::other;
}

int recorded_depth(const std::string& type) {
  return is_image(ros_message_kind(type)) ? kImageDepth : kMessageDepth;
}

std::vector<Ros2Subscription> recorded_subscriptions(const Ros2Setup& setup) {
  std::vector<Ros2Subscription> found = subscriptions_of(setup);
  for (Ros2Subscription& one : found) {
    one.topic.qos.depth = std::max(one.topic.qos.depth, recorded_depth(one.topic.type));
  }
  return found;
}

}  // namespace pcavr
