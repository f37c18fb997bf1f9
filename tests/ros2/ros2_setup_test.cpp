// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/ros2/ros2_setup.hpp"

#include <string>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"

#include "support/source_folder.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

TEST(Ros2Setup, ReadsTopicsQualityOfServiceAndFrames) {
  const auto setup = parse_ros2_setup(R"(
format: pcavr-ros2/1
domain: 7
network: {interface: lo, peers: [127.0.0.1, 10.0.0.2], multicast: false}
base_frame: /base
tool: {topic: /tool_pose, frame: tool0, reliability: reliable, depth: 3}
wrench: {topic: /ft, frame: ft_link, acts_on: tool}
transforms: {topic: /tf}
objects:
  box: {topic: /box_pose, position_std: 0.002}
camera:
  image: {topic: /camera/image_raw/compressed, compressed: true}
  info: {topic: /camera/camera_info}
  tags: tags.yaml
command: {topic: /target, rate: 250, max_distance: 0.1}
)",
                                      "folder/ros2.yaml");
  ASSERT_TRUE(setup) << setup.error().to_string();
  EXPECT_EQ(setup->dds.domain, 7U);
  EXPECT_EQ(setup->dds.peers.size(), 2U);
  EXPECT_EQ(setup->dds.multicast, false);
  EXPECT_EQ(setup->base_frame, "base");
  EXPECT_EQ(setup->tool.name, "/tool_pose");
  EXPECT_TRUE(setup->tool.qos.is_reliable);
  EXPECT_EQ(setup->tool.qos.depth, 3);
  EXPECT_FALSE(setup->wrench->qos.is_reliable);
  EXPECT_TRUE(setup->is_wrench_on_tool);
  EXPECT_TRUE(setup->static_transforms->qos.is_transient_local);
  EXPECT_EQ(setup->objects.at(0).name, "box");
  EXPECT_EQ(setup->camera->image.type, "sensor_msgs/msg/CompressedImage");
  EXPECT_EQ(setup->camera->tags, "folder/tags.yaml");
  EXPECT_EQ(setup->command_rate, 250.0);
}

TEST(Ros2Setup, ReadsWhatIsPublishedWithOrWithoutARobot) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "ros2.yaml";
  const std::string begin = "format: pcavr-ros2/1\ndomain: 9\nbase_frame: table\n";
  ASSERT_TRUE(write_file(file, begin + "publish: {prefix: /left/pcavr, rate: 20}\n"));
  const auto publication = read_ros2_publication(file);
  ASSERT_TRUE(publication) << publication.error().to_string();
  EXPECT_EQ(publication->dds.domain, 9U);
  EXPECT_EQ(publication->base_frame, "table");
  EXPECT_EQ(publication->prefix, "/left/pcavr");
  EXPECT_EQ(publication->rate, 20.0);
  const std::string robot = begin + "tool: {topic: /pose}\n";
  EXPECT_FALSE(parse_ros2_setup(robot, "ros2.yaml")->publication);
  EXPECT_EQ(parse_ros2_setup(robot + "publish: {}\n", "ros2.yaml")->publication->prefix, "/pcavr");
  ASSERT_TRUE(write_file(file, robot));
  EXPECT_NE(read_ros2_publication(file).error().message.find("nothing to publish"),
            std::string::npos);
  for (const char* wrong : {"{prefix: no_slash}", "{rate: 0}", "{topic: /a}"}) {
    ASSERT_TRUE(write_file(file, begin + "publish: " + wrong + "\n"));
    EXPECT_FALSE(read_ros2_publication(file)) << wrong;
  }
}

TEST(Ros2Setup, ReadsJointStatesInPlaceOfPoses) {
  const std::string begin = "format: pcavr-ros2/1\n";
  const auto setup = parse_ros2_setup(
      begin + "tool: {topic: /joint_states, urdf: arm.urdf, link: tool0}\n", "folder/ros2.yaml");
  ASSERT_TRUE(setup) << setup.error().to_string();
  EXPECT_EQ(setup->tool.type, "sensor_msgs/msg/JointState");
  EXPECT_EQ(setup->tool_urdf, "folder/arm.urdf");
  EXPECT_EQ(setup->tool_link, "tool0");
  EXPECT_EQ(setup->tool_frame, "tool0");
  EXPECT_FALSE(parse_ros2_setup(begin + "tool: {topic: /t, link: tool0}\n", "ros2.yaml"));
  EXPECT_FALSE(parse_ros2_setup(begin + "tool: {topic: /t, urdf: arm.urdf}\n", "ros2.yaml"));
}

TEST(Ros2Setup, SaysWhatIsWrongAndWhere) {
  const auto error_of = [](const std::string& lines) {
    const auto setup = parse_ros2_setup("format: pcavr-ros2/1\n" + lines, "ros2.yaml");
    return setup ? std::string() : setup.error().to_string();
  };
  EXPECT_EQ(error_of("tool: {topic: /tool}\n"), "");
  EXPECT_NE(error_of("domain: 1\n").find("tool"), std::string::npos);
  for (const char* name : {"tool", "/a b", "/", "//a", "/a/", "\"/a;b\""}) {
    EXPECT_NE(error_of("tool: {topic: " + std::string(name) + "}\n").find("ros2.yaml:2"),
              std::string::npos)
        << name;
  }
  EXPECT_NE(error_of("tool: {topic: /t, depth: 0}\n").find("1 to 1000"), std::string::npos);
  EXPECT_NE(error_of("tool: {topic: /t}\ndomain: 233\n").find("0 to 232"), std::string::npos);
  EXPECT_NE(error_of("tool: {topic: /t, reliability: maybe}\n").find("best_effort"),
            std::string::npos);
  EXPECT_NE(error_of("tool: {topic: /t}\ncommand: {topic: /c, type: joint_trajectory}\n")
                .find("needs the joints of the tool"),
            std::string::npos);
  EXPECT_NE(error_of("tool: {topic: /t}\ncommand: {topic: /c, orientation: free}\n")
                .find("write start or commanded"),
            std::string::npos);
  EXPECT_NE(error_of("tool: {topic: /t}\ncommand: {topic: /c, speed: 1}\n").find("speed"),
            std::string::npos);
}

TEST(Ros2Setup, ReadsTheExampleOfTheManual) {
  const auto manual = read_file(source_folder() / "docs/ros2.md");
  ASSERT_TRUE(manual);
  const std::string begin = "```yaml\n";
  const std::size_t start = manual->find(begin) + begin.size();
  const auto setup =
      parse_ros2_setup(manual->substr(start, manual->find("```", start) - start), "ros2.yaml");
  ASSERT_TRUE(setup) << setup.error().to_string();
  const Ros2Setup defaults;
  EXPECT_EQ(setup->silence_timeout, defaults.silence_timeout);
  EXPECT_EQ(setup->command_rate, defaults.command_rate);
  EXPECT_EQ(setup->max_command_distance, defaults.max_command_distance);
}

}  // namespace
}  // namespace pcavr
