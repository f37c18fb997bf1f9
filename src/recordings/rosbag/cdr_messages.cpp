// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/rosbag/cdr_messages.hpp"

#include "cdr_writer.hpp"

namespace pcavr::cdr {
namespace {

constexpr std::string_view kWrench =
    "MSG: geometry_msgs/Wrench\ngeometry_msgs/Vector3 force\ngeometry_msgs/Vector3 torque\n";
constexpr std::string_view kTransformStamped =
    "MSG: geometry_msgs/TransformStamped\nstd_msgs/Header header\nstring child_frame_id\n"
    "geometry_msgs/Transform transform\n";

}  // namespace

std::string pose_stamped_definition() {
  return definition("std_msgs/Header header\ngeometry_msgs/Pose pose\n",
                    {kHeader, kTime, kPose, kPoint, kQuaternion});
}

std::string wrench_stamped_definition() {
  return definition("std_msgs/Header header\ngeometry_msgs/Wrench wrench\n",
                    {kHeader, kTime, kWrench, kVector});
}

std::string tf_message_definition() {
  return definition("geometry_msgs/TransformStamped[] transforms\n",
                    {kTransformStamped, kHeader, kTime, kTransform, kVector, kQuaternion});
}

std::vector<std::uint8_t> pose_stamped(Stamp stamp, const Pose& T_base_child,
                                       std::string_view frame) {
  Writer writer;
  writer.header(stamp, frame);
  writer.pose(T_base_child);
  return writer.take();
}

std::vector<std::uint8_t> wrench_stamped(Stamp stamp, const Eigen::Vector3d& force,
                                         const Eigen::Vector3d& torque, std::string_view frame) {
  Writer writer;
  writer.header(stamp, frame);
  writer.vector(force);
  writer.vector(torque);
  return writer.take();
}

std::vector<std::uint8_t> tf_message(Stamp stamp, const std::vector<Transform>& transforms,
                                     std::string_view frame) {
  Writer writer;
  writer.u32(static_cast<std::uint32_t>(transforms.size()));
  for (const Transform& transform : transforms) {
    writer.header(stamp, frame);
    writer.text(transform.child_frame);
    writer.pose(transform.T_base_child);
  }
  return writer.take();
}

std::vector<std::uint8_t> joint_trajectory(Stamp stamp, const std::vector<std::string>& joints,
                                           const std::vector<double>& positions,
                                           double time_from_start) {
  Writer writer;
  writer.header(stamp, "");
  writer.u32(static_cast<std::uint32_t>(joints.size()));
  for (const std::string& joint : joints) writer.text(joint);
  writer.u32(1);  // points
  writer.u32(static_cast<std::uint32_t>(positions.size()));
  for (const double position : positions) writer.f64(position);
  for (int i = 0; i < 3; ++i) writer.u32(0);  // velocities, accelerations, effort
  writer.time(Stamp::from_seconds(time_from_start));
  return writer.take();
}

}  // namespace pcavr::cdr
