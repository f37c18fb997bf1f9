// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/ros2/ros2_joints.hpp"

#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

#include <gtest/gtest.h>

#include "ros2/planar_arm.hpp"
#include "support/ros_encoder.hpp"
#include "support/temporary_folder.hpp"
#include "teleoperation/ros2/ros2_intake.hpp"

namespace pcavr {
namespace {

class Ros2JointsTest : public testing::Test {
 protected:
  /// Sent at `t` [s]; the position of the tool that is passed on.
  std::optional<Eigen::Vector3d> pass(double t, const std::vector<std::string>& names,
                                      const std::vector<double>& position, std::size_t cut = 0) {
    RosEncoder encoder(RosEncoder::Format::cdr);
    encoder.header(Stamp::from_seconds(t), "").number(static_cast<std::uint32_t>(names.size()));
    for (const std::string& name : names) encoder.text(name);
    const std::string text = encoder.doubles(position).doubles({}).doubles({}).bytes();
    const std::vector<std::uint8_t> bytes(text.begin(),
                                          text.end() - static_cast<std::ptrdiff_t>(cut));
    intake_.on_message(0, bytes, t);
    std::vector<std::uint8_t> taken;
    if (!samples_.pop(taken)) return std::nullopt;
    Ros2Sample sample;
    std::memcpy(&sample, taken.data(), sizeof(sample));
    EXPECT_EQ(sample.kind, Ros2Sample::Kind::tool);
    return Eigen::Vector3d(sample.values[0], sample.values[1], sample.values[2]);
  }
  std::string notice() {
    std::vector<std::uint8_t> line;
    return notices_.pop(line) ? std::string(line.begin(), line.end()) : std::string();
  }

  TemporaryFolder folder_;
  Ros2Setup setup_ = planar_arm_setup(folder_.path());
  RecordQueue samples_{1U << 16U};
  RecordQueue notices_{1U << 16U};
  Ros2Notices notes_{notices_};
  Ros2Intake intake_{setup_, {}, samples_, notes_};
};

TEST_F(Ros2JointsTest, FindsTheToolByNamesInAnyOrder) {
  auto joints = read_tool_joints(setup_);
  ASSERT_TRUE(joints) << joints.error().to_string();
  intake_.set_joints(std::move(*joints));
  const Eigen::Vector3d expected(0.4 * std::cos(0.3) + 0.3 * std::cos(0.8),
                                 0.4 * std::sin(0.3) + 0.3 * std::sin(0.8), 0.0);
  const auto found = pass(10.0, {"shoulder", "elbow"}, {0.3, 0.5});
  ASSERT_TRUE(found);
  EXPECT_LT((*found - expected).norm(), 1e-12);
  const auto mixed = pass(10.1, {"grip", "elbow", "lamp", "shoulder"}, {9.0, 0.5, 7.0, 0.3});
  ASSERT_TRUE(mixed);
  EXPECT_LT((*mixed - expected).norm(), 1e-12);
  EXPECT_EQ(notice(), "");
}

TEST_F(Ros2JointsTest, IgnoresFaultyStatesWithANotice) {
  auto joints = read_tool_joints(setup_);
  ASSERT_TRUE(joints) << joints.error().to_string();
  intake_.set_joints(std::move(*joints));
  const auto expect_ignored = [&](const std::vector<std::string>& names,
                                  const std::vector<double>& position, const std::string& line,
                                  std::size_t cut = 0) {
    EXPECT_FALSE(pass(10.0, names, position, cut)) << line;
    EXPECT_EQ(notice(), "/joint_states: " + line + ": ignored");
  };
  const std::vector<std::string> both{"shoulder", "elbow"};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_ignored({"shoulder"}, {0.1}, "has no position of joint elbow");
  expect_ignored({}, {}, "has no position of joint shoulder");
  expect_ignored(both, {0.1}, "numbers of names and positions differ");
  EXPECT_FALSE(pass(10.0, both, {}));  // the same cause: no second line
  EXPECT_EQ(notice(), "");
  expect_ignored({"shoulder", "elbow", "elbow"}, {0.1, 0.2, 0.3}, "has joint elbow twice");
  expect_ignored(both, {0.1, nan}, "position of joint elbow is not finite");
  expect_ignored(both, {-2.1, 0.1}, "position of joint shoulder is beyond its limits");
  expect_ignored(std::vector<std::string>(1001, "a"), std::vector<double>(1001),
                 "has more than 1000 joints");
  expect_ignored(both, {0.1, 0.1}, "is shorter than its type sensor_msgs/msg/JointState", 1);
  EXPECT_TRUE(pass(10.0, both, {-2.01, 0.1}));  // at its stop
}

TEST_F(Ros2JointsTest, NeedsLinksOfTheDescription) {
  const auto error = [&] { return read_tool_joints(setup_).error().to_string(); };
  setup_.tool_link = "hand";
  EXPECT_NE(error().find("hand is not a link that joints move"), std::string::npos);
  setup_.tool_link = "tip";
  setup_.base_frame = "upper";
  EXPECT_NE(error().find("upper is not a link fixed to the root"), std::string::npos);
  setup_.tool_urdf = folder_.path() / "none.urdf";
  EXPECT_NE(error().find("none.urdf"), std::string::npos);
}

}  // namespace
}  // namespace pcavr
