// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/record/live_checks.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "pcavr/recordings/rosbag/cdr_messages.hpp"

namespace pcavr {
namespace {

const std::vector<RecordedTopic> kCheckedTopics{
    {"/tool", "geometry_msgs/msg/PoseStamped", RecordRole::tool},
    {"/wrench", "geometry_msgs/msg/WrenchStamped", RecordRole::wrench},
    {"/image", "sensor_msgs/msg/CompressedImage", RecordRole::image}};
constexpr std::size_t kToolIndex = 0, kWrenchIndex = 1, kImageIndex = 2;

/// Virtual seconds of a robot that publishes 100 poses and 500 wrenches a second.
class Rig {
 public:
  double t = 10.0;
  double wrench_rate = 500.0;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  double tool_speed = 0.1;  ///< [m/s]
  double tool_end = 1e9;    ///< [s] no poses from then on
  bool has_images = true;

  std::string run(double duration) {
    std::string lines;
    for (const double end = t + duration; t < end; t += 0.001) {
      x_ += 0.001 * tool_speed;
      if (is_due(100.0) && t < tool_end) {
        checks_.on_message(kToolIndex, t,
                           cdr::pose_stamped({}, Pose::from_translation({x_, 0, 0})));
      }
      if (is_due(wrench_rate)) {
        checks_.on_message(kWrenchIndex, t, cdr::wrench_stamped({}, force, {0, 0, 0}));
      }
      if (is_due(30.0) && has_images) checks_.on_message(kImageIndex, t, {});
      if (is_due(10.0)) checks_.on_time(t);
      for (const std::string& line : checks_.take_warnings()) lines += line + '\n';
    }
    return lines;
  }
  LiveChecks& checks() { return checks_; }

 private:
  [[nodiscard]] bool is_due(double rate) const {
    return std::floor(t * rate + 1e-6) > std::floor((t - 0.001) * rate + 1e-6);
  }

  LiveChecks checks_{kCheckedTopics, 10.0};
  double x_ = 0.0;
};

TEST(LiveChecks, SayNothingOfASoundRig) {
  Rig rig;
  EXPECT_EQ(rig.run(30.0), "");
}

TEST(LiveChecks, NameATopicThatIsSilentOnce) {
  Rig rig;
  EXPECT_EQ(rig.run(5.0), "");
  rig.tool_end = rig.t;
  const std::string lines = rig.run(5.0);
  EXPECT_NE(lines.find("/tool: no message for 0."), std::string::npos) << lines;
  EXPECT_EQ(std::count(lines.begin(), lines.end(), '\n'), 1) << lines;
  rig.tool_end = 1e9;
  EXPECT_EQ(rig.run(1.0), "/tool: messages again after 5.0 s\n");
}

// Where the disk is too slow, the source must not be blamed.
TEST(LiveChecks, NameDropsAndNoGapWhereTheDiskIsTooSlow) {
  Rig rig;
  EXPECT_EQ(rig.run(5.0), "");
  rig.tool_end = rig.t;
  std::string lines;
  for (std::uint64_t i = 1; i <= 50; ++i) {
    rig.checks().on_dropped(kToolIndex, rig.t, 10 * i);
    lines += rig.run(0.1);
  }
  rig.tool_end = 1e9;
  lines += rig.run(5.0);
  EXPECT_EQ(lines, "/tool: 10 messages dropped: the disk is too slow\n");
}

TEST(LiveChecks, NameATopicThatNeverCame) {
  Rig rig;
  rig.has_images = false;
  EXPECT_EQ(rig.run(10.0), "/image: no message in 3 s\n");
}

TEST(LiveChecks, NameARateThatFalls) {
  Rig rig;
  EXPECT_EQ(rig.run(6.0), "");
  rig.wrench_rate = 250.0;
  const std::string lines = rig.run(8.0);
  EXPECT_NE(lines.find(" Hz, at first 500 Hz"), std::string::npos) << lines;
  EXPECT_EQ(std::count(lines.begin(), lines.end(), '\n'), 1) << lines;
}

TEST(LiveChecks, NameAForceAtRestOnlyWhileTheToolRests) {
  Rig rig;
  rig.force = {0, 3, -4};
  EXPECT_EQ(rig.run(5.0), "");  // it moves: it may push
  rig.tool_speed = 0.0;
  const std::string lines = rig.run(5.0);
  EXPECT_EQ(lines,
            "/wrench: 5.00 N while the tool rests (x 0.00, y 3.00, z -4.00): if it touches "
            "nothing, set the sensor to zero, or import with --tare\n");
}

TEST(LiveChecks, TakeASmallForceAtRestAsZero) {
  Rig rig;
  rig.force = {0, 0.5, 0.5};
  rig.tool_speed = 0.0;
  EXPECT_EQ(rig.run(5.0), "");
}

TEST(LiveChecks, NameTagsThatAreOutOfView) {
  Rig rig;
  const auto look = [&](std::size_t tags) { rig.checks().on_tags(kImageIndex, rig.t, tags); };
  std::string lines;
  for (int i = 0; i < 8; ++i) {
    look(i < 2 ? 3 : 0);
    lines += rig.run(1.0);
  }
  EXPECT_EQ(lines, "/image: no declared tag is in view for 5 s\n");
  look(1);
  EXPECT_EQ(rig.run(0.5), "/image: tags are in view again\n");
}

TEST(LiveChecks, NameMessagesThatCanNotBeDecoded) {
  Rig rig;
  const std::vector<std::uint8_t> noise(3, 1);
  rig.checks().on_message(kWrenchIndex, rig.t, noise);
  rig.checks().on_message(kWrenchIndex, rig.t, noise);
  const std::vector<std::string> lines = rig.checks().take_warnings();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_TRUE(lines[0].starts_with("/wrench: ")) << lines[0];
}

}  // namespace
}  // namespace pcavr
