// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/rosbag/ros_messages.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "recordings/rosbag/payload_reader.hpp"

namespace pcavr {
namespace {

constexpr std::pair<std::string_view, RosMessageKind> kRosTypes[] = {
    {"sensor_msgs/Image", RosMessageKind::image},
    {"sensor_msgs/CompressedImage", RosMessageKind::compressed_image},
    {"sensor_msgs/CameraInfo", RosMessageKind::camera_info},
    {"sensor_msgs/JointState", RosMessageKind::joint_state},
    {"geometry_msgs/PoseStamped", RosMessageKind::pose},
    {"geometry_msgs/PoseWithCovarianceStamped", RosMessageKind::pose},
    {"geometry_msgs/Pose", RosMessageKind::pose},
    {"nav_msgs/Odometry", RosMessageKind::pose},
    {"geometry_msgs/PointStamped", RosMessageKind::point},
    {"geometry_msgs/WrenchStamped", RosMessageKind::wrench},
    {"geometry_msgs/Wrench", RosMessageKind::wrench},
    {"geometry_msgs/TransformStamped", RosMessageKind::transform},
    {"tf2_msgs/TFMessage", RosMessageKind::transforms},
    {"tf/tfMessage", RosMessageKind::transforms},
};

/// "sensor_msgs/msg/Image" as "sensor_msgs/Image".
std::string short_type(std::string_view type) {
  std::string name(type);
  if (const std::size_t at = name.find("/msg/"); at != name.npos) name.erase(at, 4);
  return name;
}

/// sec and nanosec are signed and unsigned in ROS 2, both unsigned in ROS 1.
std::optional<Stamp> read_ros_stamp(PayloadReader& in) {
  const auto seconds = in.number<std::uint32_t>();
  const auto nanoseconds = in.number<std::uint32_t>();
  if (seconds == 0 && nanoseconds == 0) return std::nullopt;
  const std::int64_t whole =
      in.is_cdr() ? static_cast<std::int32_t>(seconds) : static_cast<std::int64_t>(seconds);
  return Stamp{whole * 1'000'000'000 + nanoseconds};
}

RosHeader read_ros_header(PayloadReader& in) {
  if (!in.is_cdr()) (void)in.number<std::uint32_t>();  // seq
  RosHeader header;
  header.stamp = read_ros_stamp(in);
  header.frame = frame_name(in.text());
  return header;
}

Eigen::Vector3d read_ros_vector(PayloadReader& in) {
  const auto x = in.number<double>();
  const auto y = in.number<double>();
  return {x, y, in.number<double>()};
}

Eigen::Quaterniond read_ros_quaternion(PayloadReader& in) {
  const Eigen::Vector3d xyz = read_ros_vector(in);
  return {in.number<double>(), xyz.x(), xyz.y(), xyz.z()};
}

bool is_rotation(const Eigen::Quaterniond& q) {
  // Written with three or four digits by some; unset ones have norm 0.
  constexpr double kTolerance = 0.01;
  return std::abs(q.norm() - 1.0) < kTolerance;
}

Error not_finite() { return {.message = "has numbers that are not finite"}; }

/// Positive sizes that fit into int, and rows that are in the data.
Expected<RosMessage> read_image(PayloadReader& in) {
  RosImage image;
  image.header = read_ros_header(in);
  const auto height = in.number<std::uint32_t>();
  const auto width = in.number<std::uint32_t>();
  image.encoding = printable_name(in.text());
  image.is_big_endian = in.number<std::uint8_t>() != 0;
  image.step = in.number<std::uint32_t>();
  image.data = in.byte_sequence();
  constexpr std::uint32_t kMaxSide = 1U << 16;
  if (width == 0 || height == 0 || width > kMaxSide || height > kMaxSide ||
      image.data.size() < std::uint64_t{image.step} * height) {
    return Error{.message = "image of " + std::to_string(width) + " x " + std::to_string(height) +
                            " pixels with " + std::to_string(image.data.size()) + " bytes"};
  }
  image.width = static_cast<int>(width);
  image.height = static_cast<int>(height);
  return RosMessage(std::move(image));
}

Expected<RosMessage> read_compressed_image(PayloadReader& in) {
  RosCompressedImage image;
  image.header = read_ros_header(in);
  image.format = printable_name(in.text());
  image.data = in.byte_sequence();
  return RosMessage(std::move(image));
}

Expected<RosMessage> read_camera_info(PayloadReader& in) {
  RosCameraInfo info;
  info.header = read_ros_header(in);
  const auto height = in.number<std::uint32_t>();
  const auto width = in.number<std::uint32_t>();
  info.distortion_model = printable_name(in.text());
  info.distortion = in.double_sequence();
  const auto matrix = [&](auto& into, int rows, int columns) {
    for (int i = 0; i < rows * columns; ++i) into(i / columns, i % columns) = in.number<double>();
  };
  Eigen::Matrix3d rectification;
  matrix(info.intrinsics, 3, 3);
  matrix(rectification, 3, 3);
  matrix(info.projection, 3, 4);
  constexpr std::uint32_t kMaxSide = 1U << 16;
  bool is_in_range = width <= kMaxSide && height <= kMaxSide;
  const auto pixels = [&] {
    const auto count = in.number<std::uint32_t>();
    is_in_range = is_in_range && count <= kMaxSide;
    return static_cast<int>(std::min(count, kMaxSide));
  };
  info.binning_x = std::max(pixels(), 1);  // 0 means the same as 1
  info.binning_y = std::max(pixels(), 1);
  info.region_x = pixels();
  info.region_y = pixels();
  info.region_height = pixels();
  info.region_width = pixels();
  if (!is_in_range) return Error{.message = "camera info without size"};
  info.width = static_cast<int>(width);
  info.height = static_cast<int>(height);
  return RosMessage(std::move(info));
}

Expected<RosMessage> read_joint_state(PayloadReader& in) {
  RosJointState state;
  state.header = read_ros_header(in);
  constexpr std::size_t kMaxJoints = 10'000;  // an empty name takes eight times its bytes in memory
  const std::size_t joints = in.length(4);
  if (joints > kMaxJoints) return Error{.message = "has " + std::to_string(joints) + " joints"};
  state.names.resize(joints);
  for (std::string& name : state.names) name = printable_name(in.text());
  state.position = in.double_sequence();
  state.velocity = in.double_sequence();
  state.effort = in.double_sequence();
  return RosMessage(std::move(state));
}

Expected<RosMessage> read_pose(PayloadReader& in, const std::string& type) {
  RosPose pose;
  if (type != "geometry_msgs/Pose") pose.header = read_ros_header(in);
  if (type == "nav_msgs/Odometry") pose.child_frame = frame_name(in.text());
  pose.position = read_ros_vector(in);
  if (type != "geometry_msgs/PointStamped") pose.orientation = read_ros_quaternion(in);
  if (!in.is_valid()) return RosMessage(std::move(pose));
  if (!pose.position.allFinite()) return not_finite();
  // Zero where the sender has no orientation.
  if (pose.orientation && pose.orientation->norm() == 0.0) pose.orientation.reset();
  if (pose.orientation && !is_rotation(*pose.orientation)) {
    return Error{.message = "has a quaternion that is no rotation"};
  }
  return RosMessage(std::move(pose));
}

Expected<RosMessage> read_wrench(PayloadReader& in, const std::string& type) {
  RosWrench wrench;
  if (type != "geometry_msgs/Wrench") wrench.header = read_ros_header(in);
  wrench.force = read_ros_vector(in);
  wrench.torque = read_ros_vector(in);
  if (!wrench.force.allFinite() || !wrench.torque.allFinite()) return not_finite();
  return RosMessage(std::move(wrench));
}

Expected<RosMessage> read_transforms(PayloadReader& in, bool is_one) {
  RosTransforms found;
  constexpr std::size_t kMinSize = 64;  // of a transform: stamp, two empty texts, seven numbers
  const std::size_t count = is_one ? 1 : in.length(kMinSize);
  for (std::size_t i = 0; i < count && in.is_valid(); ++i) {
    RosTransform transform;
    transform.header = read_ros_header(in);
    transform.child_frame = frame_name(in.text());
    transform.translation = read_ros_vector(in);
    transform.rotation = read_ros_quaternion(in);
    const bool is_usable = transform.translation.allFinite() && is_rotation(transform.rotation);
    if (is_usable) found.transforms.push_back(std::move(transform));
    if (!is_usable) ++found.left_out;
  }
  return RosMessage(std::move(found));
}

Expected<RosMessage> read_by_kind(PayloadReader& in, RosMessageKind kind, const std::string& type) {
  switch (kind) {
    case RosMessageKind::image:
      return read_image(in);
    case RosMessageKind::compressed_image:
      return read_compressed_image(in);
    case RosMessageKind::camera_info:
      return read_camera_info(in);
    case RosMessageKind::joint_state:
      return read_joint_state(in);
    case RosMessageKind::pose:
    case RosMessageKind::point:
      return read_pose(in, type);
    case RosMessageKind::wrench:
      return read_wrench(in, type);
    case RosMessageKind::transform:
    case RosMessageKind::transforms:
      return read_transforms(in, kind == RosMessageKind::transform);
    case RosMessageKind::other:
      break;
  }
  return RosMessage();
}

}  // namespace

RosMessageKind ros_message_kind(std::string_view type) {
  const std::string name = short_type(type);
  for (const auto& [known, kind] : kRosTypes) {
    if (name == known) return kind;
  }
  return RosMessageKind::other;
}

bool is_static_tf(std::string_view topic) {
  return topic == "tf_static" || topic.ends_with("/tf_static");
}

std::string frame_name(std::string_view frame) {
  frame.remove_prefix(std::min(frame.find_first_not_of('/'), frame.size()));
  return printable_name(frame);
}

bool is_decodable_encoding(std::string_view encoding) {
  return encoding == "ros1" || encoding == "cdr";
}

Expected<RosMessage> decode_ros_message(const BagTopic& topic,
                                        std::span<const std::uint8_t> payload) {
  const RosMessageKind kind = ros_message_kind(topic.type);
  if (kind == RosMessageKind::other) return RosMessage();
  if (!is_decodable_encoding(topic.encoding)) {
    return Error{.message = "is serialised as '" + topic.encoding + "', not as ros1 or cdr"};
  }
  PayloadReader in(payload, topic.encoding == "cdr");
  if (!in.is_valid()) return Error{.message = "has no header of plain CDR"};
  Expected<RosMessage> message = read_by_kind(in, kind, short_type(topic.type));
  if (!in.is_valid()) return Error{.message = "is shorter than its type " + topic.type};
  return message;
}

}  // namespace pcavr
