// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/stamp.hpp"
#include "pcavr/recordings/rosbag/bag_reader.hpp"

namespace pcavr {

/// The message types that are decoded, of ROS 1 and ROS 2 alike.
enum class RosMessageKind {
  other,             ///< listed, but not decoded
  image,             ///< sensor_msgs/Image
  compressed_image,  ///< sensor_msgs/CompressedImage
  camera_info,       ///< sensor_msgs/CameraInfo
  joint_state,       ///< sensor_msgs/JointState
  /// geometry_msgs/PoseStamped, PoseWithCovarianceStamped, Pose, nav_msgs/Odometry
  pose,
  point,       ///< geometry_msgs/PointStamped: a pose without orientation
  wrench,      ///< geometry_msgs/WrenchStamped, Wrench
  transform,   ///< geometry_msgs/TransformStamped
  transforms,  ///< tf2_msgs/TFMessage, tf/tfMessage
};

/// The kind of the messages of a type, named with or without "/msg/".
[[nodiscard]] RosMessageKind ros_message_kind(std::string_view type);

/// Whether transforms of the topic hold until they are replaced [ROS tf2]: "/tf_static", also in a
/// namespace.
[[nodiscard]] bool is_static_tf(std::string_view topic);

/// The name of a frame without its leading slashes, which ROS 1 once wrote.
[[nodiscard]] std::string frame_name(std::string_view frame);

struct RosHeader {
  std::optional<Stamp> stamp;  ///< nullopt where it is zero, or the message has no header
  std::string frame;           ///< without leading slash; may be empty
};

struct RosImage {
  RosHeader header;
  int width = 0;         ///< [px]
  int height = 0;        ///< [px]
  std::string encoding;  ///< "16UC1", "rgb8", ...
  bool is_big_endian = false;
  std::uint32_t step = 0;              ///< bytes of a row
  std::span<const std::uint8_t> data;  ///< in the payload; at least height * step bytes
};

struct RosCompressedImage {
  RosHeader header;
  std::string format;                  ///< "jpeg", "16UC1; compressedDepth png", ...
  std::span<const std::uint8_t> data;  ///< in the payload
};

struct RosCameraInfo {
  RosHeader header;
  int width = 0;   ///< [px]
  int height = 0;  ///< [px]
  std::string distortion_model;
  std::vector<double> distortion;          ///< D
  Eigen::Matrix3d intrinsics;              ///< K, of the raw image
  Eigen::Matrix<double, 3, 4> projection;  ///< P, of the rectified image
  /// The part of the full sensor that the image shows [REP 104]: one of every `binning` columns and
  /// rows of the region, whose size is 0 for the whole sensor [px of the full sensor].
  int binning_x = 1, binning_y = 1;
  int region_x = 0, region_y = 0, region_width = 0, region_height = 0;
};

struct RosJointState {
  RosHeader header;
  std::vector<std::string> names;
  std::vector<double> position;  ///< [rad]; these three are empty or have one for each name
  std::vector<double> velocity;  ///< [rad/s]
  std::vector<double> effort;    ///< [N m]
};

struct RosPose {
  RosHeader header;
  std::string child_frame;                        ///< of an odometry; else empty
  Eigen::Vector3d position;                       ///< [m] in the header's frame
  std::optional<Eigen::Quaterniond> orientation;  ///< nullopt for a point and where zero
};

struct RosWrench {
  RosHeader header;
  Eigen::Vector3d force;   ///< [N]
  Eigen::Vector3d torque;  ///< [N m]
};

struct RosTransform {
  RosHeader header;
  std::string child_frame;
  Eigen::Vector3d translation;  ///< [m] of the child in the header's frame
  Eigen::Quaterniond rotation;  ///< |q| is 1 to 0.01
};

/// One for a TransformStamped. `left_out` are those whose numbers are not finite or no rotation.
struct RosTransforms {
  std::vector<RosTransform> transforms;
  std::size_t left_out = 0;
};

using RosMessage = std::variant<std::monostate, RosImage, RosCompressedImage, RosCameraInfo,
                                RosJointState, RosPose, RosWrench, RosTransforms>;

/// Whether payloads of this encoding are decoded: "ros1" [ROS serialization] or "cdr" [OMG
/// DDS-XTypes 1.3, plain CDR of version 1 or 2, either byte order].
[[nodiscard]] bool is_decodable_encoding(std::string_view encoding);

/// Decodes a message of a topic by its type's fixed, published definition; monostate for
/// RosMessageKind::other. An Error (without file) for a payload that is too short, an encoding that
/// is not decodable, numbers that are not finite, and a quaternion that is no rotation. Safe for
/// untrusted bytes. Pure function.
[[nodiscard]] Expected<RosMessage> decode_ros_message(const BagTopic& topic,
                                                      std::span<const std::uint8_t> payload);

}  // namespace pcavr
