// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/rosbag/ros_messages.hpp"

#include <string>

#include <gtest/gtest.h>

#include "support/read_bag.hpp"
#include "support/ros_encoder.hpp"

namespace pcavr {
namespace {

using Format = RosEncoder::Format;

/// Each message is decoded alike in every serialization.
class RosMessages : public testing::TestWithParam<Format> {
 protected:
  static RosEncoder encoder() { return RosEncoder(GetParam()); }

  template <typename Message>
  static Message decode(const std::string& ros1_type, const RosEncoder& encoded) {
    const bool is_ros1 = GetParam() == Format::ros1;
    std::string type = ros1_type;
    if (!is_ros1) type.insert(type.find('/'), "/msg");
    const BagTopic topic{.name = "/t",
                         .type = type,
                         .encoding = is_ros1 ? "ros1" : "cdr",
                         .schema_encoding = {},
                         .schema = {}};
    const std::string& bytes = encoded.bytes();
    // Never reads past the end: each shorter payload is an error, or has lost only trailing fields.
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      (void)decode_ros_message(topic, test::bytes_of(bytes).first(size));
    }
    EXPECT_FALSE(decode_ros_message(topic, test::bytes_of(bytes).first(bytes.size() / 2)));
    const Expected<RosMessage> message = decode_ros_message(topic, test::bytes_of(bytes));
    EXPECT_TRUE(message) << (message ? "" : message.error().to_string());
    return message ? std::get<Message>(*message) : Message{};
  }

  static constexpr Stamp kAt{1'600'000'000'123'456'789};
  static Pose some_pose() {
    return Pose(Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5), Eigen::Vector3d(1.0, -2.0, 3.5));
  }
};

TEST_P(RosMessages, Poses) {
  const auto stamped = decode<RosPose>("geometry_msgs/PoseStamped",
                                       encoder().header(kAt, "/odom").pose(some_pose()));
  EXPECT_EQ(stamped.header.stamp, kAt);
  EXPECT_EQ(stamped.header.frame, "odom");
  EXPECT_EQ(stamped.position, Eigen::Vector3d(1.0, -2.0, 3.5));
  ASSERT_TRUE(stamped.orientation);
  EXPECT_EQ(stamped.orientation->coeffs(), Eigen::Vector4d(0.5, -0.5, 0.5, 0.5));
  RosEncoder odometry = encoder();
  odometry.header({}, "map").text("rig").pose(some_pose());
  const auto body = decode<RosPose>("nav_msgs/Odometry", odometry);
  EXPECT_FALSE(body.header.stamp);
  EXPECT_EQ(body.child_frame, "rig");
  EXPECT_EQ(body.position.z(), 3.5);
  const auto point = decode<RosPose>("geometry_msgs/PointStamped",
                                     encoder().header(kAt, "abc").vector({4.0, 5.0, 6.0}));
  EXPECT_FALSE(point.orientation);
  EXPECT_EQ(point.position, Eigen::Vector3d(4.0, 5.0, 6.0));
}

TEST_P(RosMessages, WrenchAndTransforms) {
  const auto wrench = decode<RosWrench>(
      "geometry_msgs/WrenchStamped",
      encoder().header(kAt, "ft").vector({1.0, 2.0, 3.0}).vector({4.0, 5.0, 6.0}));
  EXPECT_EQ(wrench.force, Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(wrench.torque, Eigen::Vector3d(4.0, 5.0, 6.0));
  RosEncoder tf = encoder();
  tf.number(std::uint32_t{2}).transform(kAt, "base", "link", some_pose());
  tf.transform(kAt, "link", "/tip", some_pose());
  const auto found = decode<RosTransforms>("tf2_msgs/TFMessage", tf);
  ASSERT_EQ(found.transforms.size(), 2U);
  EXPECT_EQ(found.transforms[1].header.frame, "link");
  EXPECT_EQ(found.transforms[1].child_frame, "tip");
  EXPECT_EQ(found.transforms[1].translation, Eigen::Vector3d(1.0, -2.0, 3.5));
}

TEST_P(RosMessages, JointsImagesAndCamera) {
  RosEncoder joints = encoder();
  joints.header(kAt, "").number(std::uint32_t{2}).text("j1").text("gripper");
  joints.doubles({0.5, 1.5}).doubles({}).doubles({7.0, 8.0});
  const auto state = decode<RosJointState>("sensor_msgs/JointState", joints);
  EXPECT_EQ(state.names, (std::vector<std::string>{"j1", "gripper"}));
  EXPECT_EQ(state.position, (std::vector<double>{0.5, 1.5}));
  EXPECT_TRUE(state.velocity.empty());
  EXPECT_EQ(state.effort, (std::vector<double>{7.0, 8.0}));
  const auto image =
      decode<RosImage>("sensor_msgs/Image", encoder().image(kAt, "c", 3, 2, "mono8", "abcdef"));
  EXPECT_EQ(image.width, 3);
  EXPECT_EQ(image.height, 2);
  EXPECT_EQ(image.data.size(), 6U);
  const auto info = decode<RosCameraInfo>(
      "sensor_msgs/CameraInfo", encoder().camera_info(kAt, "c", 640, 480, 500.0, 320.0, 241.0));
  EXPECT_EQ(info.width, 640);
  EXPECT_EQ(info.intrinsics(1, 2), 241.0);
  EXPECT_EQ(info.projection(0, 0), 500.0);
  EXPECT_EQ(info.distortion.size(), 5U);
  EXPECT_EQ(info.binning_x, 1) << "0 means none";
  const auto region = decode<RosCameraInfo>(
      "sensor_msgs/CameraInfo",
      encoder().camera_info(kAt, "c", 640, 480, 500.0, 320.0, 241.0, {2, 3, 10, 20, 200, 300}));
  EXPECT_EQ(region.binning_x, 2);
  EXPECT_EQ(region.binning_y, 3);
  EXPECT_EQ(region.region_x, 10);
  EXPECT_EQ(region.region_y, 20);
  EXPECT_EQ(region.region_width, 300);
  EXPECT_EQ(region.region_height, 200);
}

INSTANTIATE_TEST_SUITE_P(Serializations, RosMessages,
                         testing::Values(Format::ros1, Format::cdr, Format::cdr_big_endian));

TEST(RosMessageErrors, AreOneLine) {
  const BagTopic topic{.name = "/p",
                       .type = "geometry_msgs/msg/PoseStamped",
                       .encoding = "cdr",
                       .schema_encoding = {},
                       .schema = {}};
  const auto error_of = [](const BagTopic& of, const std::string& bytes) {
    const auto message = decode_ros_message(of, test::bytes_of(bytes));
    return message ? std::string() : message.error().message;
  };
  EXPECT_EQ(error_of(topic, std::string("\0\3\0\0", 4)), "has no header of plain CDR");
  RosEncoder bad(Format::cdr);
  bad.header({1}, "a").vector({1.0, 2.0, 3.0}).vector({1.0, 1.0, 1.0}).number(1.0);
  EXPECT_EQ(error_of(topic, bad.bytes()), "has a quaternion that is no rotation");
  BagTopic json = topic;
  json.encoding = "json";
  EXPECT_EQ(error_of(json, "{}"), "is serialised as 'json', not as ros1 or cdr");
  // A length of four billion items does not allocate them.
  const BagTopic joints{.name = "/j",
                        .type = "sensor_msgs/JointState",
                        .encoding = "ros1",
                        .schema_encoding = {},
                        .schema = {}};
  RosEncoder many(Format::ros1);
  many.header({1}, "").number(0xFFFFFFFFU);
  EXPECT_EQ(error_of(joints, many.bytes()), "is shorter than its type sensor_msgs/JointState");
  // Small messages that would take far more memory than they have bytes.
  RosEncoder empty_names(Format::ros1);
  empty_names.header({1}, "").number(20'000U);
  EXPECT_EQ(error_of(joints, empty_names.bytes() + std::string(80'000, '\0')), "has 20000 joints");
  RosEncoder long_name(Format::ros1);
  long_name.header({1}, std::string(70'000, 'x'));
  EXPECT_NE(error_of(joints, long_name.bytes()), "");
}

}  // namespace
}  // namespace pcavr
