// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/message.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/random.hpp"

namespace pcavr {
namespace {

constexpr double kEpoch = 1305031480.0;

CorrectionMessage full_message() {
  CorrectionMessage message;
  message.t = kEpoch + 12.34567;
  message.object = 3;
  message.sequence = 200;
  message.which = CorrectionCase::touched_by_robot;
  message.pose = PlanarPose{0.5, -0.25, 0.125};
  message.twist = Eigen::Vector3d(0.0625, 0.0, -0.5);
  message.tool_retraction = Eigen::Vector3d(0.0, 0.0, 0.25);
  message.parameters.mass = ParameterValue{3.0};
  message.parameters.limiting_static_friction = ParameterValue{9.5, 0.75};
  message.parameters.contact_exponent = ParameterValue{1.5};
  message.parameters.contact_surface_offset = Eigen::Vector3d(0.0, -0.0078125, 0.0);
  message.parameters.limit_surface = ellipsoid_surface(8.0, 0.5);
  return message;
}

TEST(Message, SurvivesARoundTrip) {
  const CorrectionMessage sent = full_message();
  const auto message = decode(encode(sent, kEpoch), kEpoch);
  ASSERT_TRUE(message);
  EXPECT_NEAR(message->t, sent.t, 0.5e-5);
  EXPECT_EQ(message->object, sent.object);
  EXPECT_EQ(message->sequence, sent.sequence);
  EXPECT_EQ(message->which, sent.which);
  EXPECT_EQ(message->pose->x, sent.pose->x);  // powers of two: exact in single precision
  EXPECT_EQ(message->pose->yaw, sent.pose->yaw);
  EXPECT_EQ(*message->twist, *sent.twist);
  EXPECT_EQ(*message->tool_retraction, *sent.tool_retraction);
  EXPECT_EQ(message->parameters.mass->value, 3.0);
  EXPECT_EQ(message->parameters.limiting_static_friction->std, 0.75);
  EXPECT_FALSE(message->parameters.contact_stiffness);
  EXPECT_EQ(message->parameters.contact_surface_offset, sent.parameters.contact_surface_offset);
  EXPECT_NEAR(message->parameters.limit_surface->coefficients[0],
              sent.parameters.limit_surface->coefficients[0], 1e-6);
}

TEST(Message, HasOnlyTheBytesOfItsContent) {
  CorrectionMessage message{.t = kEpoch, .pose = PlanarPose{}};
  EXPECT_EQ(encode(message, kEpoch).size(), 7U + 12U);
  message.parameters.mass = ParameterValue{1.0};
  EXPECT_EQ(encode(message, kEpoch).size(), 7U + 12U + 2U + 4U);
  EXPECT_EQ(bytes_of_tracked_pose(), 19U);
  EXPECT_EQ(bytes_of_wrench_sample(), 19U);
}

TEST(Message, RejectsTruncationAndTrailingBytes) {
  std::vector<std::uint8_t> bytes = encode(full_message(), kEpoch);
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    EXPECT_FALSE(decode(std::span(bytes).first(length), kEpoch)) << length;
  }
  bytes.push_back(0);
  EXPECT_FALSE(decode(bytes, kEpoch));
}

TEST(Message, RejectsNumbersThatAreNotFinite) {
  CorrectionMessage message{.t = kEpoch, .pose = PlanarPose{}};
  message.pose->x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(decode(encode(message, kEpoch), kEpoch));
}

TEST(Message, RejectsUnknownParameters) {
  CorrectionMessage message{.t = kEpoch};
  message.parameters.mass = ParameterValue{1.0};
  std::vector<std::uint8_t> bytes = encode(message, kEpoch);
  const std::size_t fields = 7;  // after flags, object, sequence and time
  ASSERT_TRUE(decode(bytes, kEpoch));
  bytes[fields + 1] = 0x20;  // a field that no message has
  EXPECT_FALSE(decode(bytes, kEpoch));
  bytes[fields + 1] = 0;
  bytes[fields] = 0;  // announced, but empty
  EXPECT_FALSE(decode(std::span(bytes).first(fields + 2), kEpoch));
}

TEST(Message, SurvivesRandomBytes) {
  Random random(9);
  int accepted = 0;
  for (int i = 0; i < 20000; ++i) {
    std::vector<std::uint8_t> bytes(random.below(64));
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random.bits());
    const auto message = decode(bytes, 0.0);
    if (!message) continue;
    ++accepted;
    EXPECT_EQ(encode(*message, 0.0), bytes);  // the encoding is unique
  }
  EXPECT_GT(accepted, 0);
}

TEST(Message, RejectsTimesOutOfRange) {
  EXPECT_THROW((void)encode({.t = kEpoch - 1.0}, kEpoch), ContractError);
  EXPECT_THROW((void)encode({.t = kEpoch + 50000.0}, kEpoch), ContractError);
}

TEST(Message, PlanarPoseSurvivesARoundTrip) {
  const Pose T_base_start(Eigen::Quaterniond(Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitY())),
                          {0.1, 0.2, 0.0625});
  const Pose T_base_object = pose_at({0.6, -0.1, 0.4}, T_base_start);
  const PlanarPose pose = planar_pose_of(T_base_object);
  EXPECT_NEAR(pose.x, 0.6, 1e-12);
  EXPECT_NEAR(pose.yaw, 0.4, 1e-9);
  EXPECT_NEAR(T_base_object.translation().z(), 0.0625, 1e-12);
}

TEST(Message, DescribesItsContent) {
  CorrectionMessage message{.pose = PlanarPose{}};
  EXPECT_EQ(describe(message), "position");
  message.parameters.contact_stiffness = ParameterValue{1.0};
  message.parameters.mass = ParameterValue{1.0};
  EXPECT_EQ(describe(message), "position+contact parameters+friction parameters");
}

}  // namespace
}  // namespace pcavr
