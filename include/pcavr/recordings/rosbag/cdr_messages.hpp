// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/stamp.hpp"
#include "pcavr/base/geometry/pose.hpp"

namespace pcavr::cdr {

/// ROS 2 messages in CDR, little endian [OMG DDSI-RTPS 10.2, XCDR1], with the definitions of their
/// types as bags state them (ros2msg).

inline constexpr std::string_view kPoseStampedType = "geometry_msgs/msg/PoseStamped";
inline constexpr std::string_view kWrenchStampedType = "geometry_msgs/msg/WrenchStamped";
inline constexpr std::string_view kTfMessageType = "tf2_msgs/msg/TFMessage";
[[nodiscard]] std::string pose_stamped_definition();
[[nodiscard]] std::string wrench_stamped_definition();
[[nodiscard]] std::string tf_message_definition();

struct Transform {
  std::string child_frame;
  Pose T_base_child;
};

[[nodiscard]] std::vector<std::uint8_t> pose_stamped(Stamp stamp, const Pose& T_base_child,
                                                     std::string_view frame = "base");
[[nodiscard]] std::vector<std::uint8_t> wrench_stamped(Stamp stamp, const Eigen::Vector3d& force,
                                                       const Eigen::Vector3d& torque,
                                                       std::string_view frame = "base");
[[nodiscard]] std::vector<std::uint8_t> tf_message(Stamp stamp,
                                                   const std::vector<Transform>& transforms,
                                                   std::string_view frame = "base");

/// A trajectory_msgs/msg/JointTrajectory of one point, without velocities: `positions` [rad] or [m]
/// are to be reached `time_from_start` [s] >= 0 after `stamp`; a stamp of 0 is the arrival.
[[nodiscard]] std::vector<std::uint8_t> joint_trajectory(Stamp stamp,
                                                         const std::vector<std::string>& joints,
                                                         const std::vector<double>& positions,
                                                         double time_from_start);

}  // namespace pcavr::cdr
