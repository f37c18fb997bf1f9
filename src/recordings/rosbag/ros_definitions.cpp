// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/rosbag/ros_definitions.hpp"

#include <algorithm>
#include <iterator>

#include "pcavr/recordings/rosbag/cdr_camera_info.hpp"
#include "pcavr/recordings/rosbag/cdr_messages.hpp"
#include "pcavr/recordings/rosbag/cdr_scene_messages.hpp"

#include "cdr_writer.hpp"

namespace pcavr {
namespace {

using cdr::kHeader;
using cdr::kPoint;
using cdr::kPose;
using cdr::kQuaternion;
using cdr::kTime;
using cdr::kTransform;
using cdr::kVector;

constexpr std::string_view kPoseWithCovariance =
    "MSG: geometry_msgs/PoseWithCovariance\ngeometry_msgs/Pose pose\nfloat64[36] covariance\n";
constexpr std::string_view kTwistWithCovariance =
    "MSG: geometry_msgs/TwistWithCovariance\ngeometry_msgs/Twist twist\nfloat64[36] covariance\n";
constexpr std::string_view kTwist =
    "MSG: geometry_msgs/Twist\ngeometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n";

std::string image_definition() {
  return cdr::definition(
      "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\n"
      "uint8 is_bigendian\nuint32 step\nuint8[] data\n",
      {kHeader, kTime});
}

std::string point_stamped_definition() {
  return cdr::definition("std_msgs/Header header\ngeometry_msgs/Point point\n",
                         {kHeader, kTime, kPoint});
}

std::string pose_with_covariance_definition() {
  return cdr::definition("std_msgs/Header header\ngeometry_msgs/PoseWithCovariance pose\n",
                         {kHeader, kTime, kPoseWithCovariance, kPose, kPoint, kQuaternion});
}

std::string odometry_definition() {
  return cdr::definition(
      "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n"
      "geometry_msgs/TwistWithCovariance twist\n",
      {kHeader, kTime, kPoseWithCovariance, kPose, kPoint, kQuaternion, kTwistWithCovariance,
       kTwist, kVector});
}

std::string transform_stamped_definition() {
  return cdr::definition(
      "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n",
      {kHeader, kTime, kTransform, kVector, kQuaternion});
}

struct Definition {
  std::string_view type;
  std::string (*text)();
};
constexpr Definition kDefinitions[] = {
    {cdr::kPoseStampedType, cdr::pose_stamped_definition},
    {cdr::kWrenchStampedType, cdr::wrench_stamped_definition},
    {cdr::kTfMessageType, cdr::tf_message_definition},
    {cdr::kJointStateType, cdr::joint_state_definition},
    {cdr::kCameraInfoType, cdr::camera_info_definition},
    {cdr::kCompressedImageType, cdr::compressed_image_definition},
    {"sensor_msgs/msg/Image", image_definition},
    {"geometry_msgs/msg/PointStamped", point_stamped_definition},
    {"geometry_msgs/msg/PoseWithCovarianceStamped", pose_with_covariance_definition},
    {"geometry_msgs/msg/TransformStamped", transform_stamped_definition},
    {"nav_msgs/msg/Odometry", odometry_definition},
};

}  // namespace

std::string ros_message_definition(std::string_view type) {
  const auto* const found =
      std::find_if(std::begin(kDefinitions), std::end(kDefinitions),
                   [&](const Definition& known) { return known.type == type; });
  return found == std::end(kDefinitions) ? std::string() : found->text();
}

}  // namespace pcavr
