// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/plugin_robot.hpp"

#include <gtest/gtest.h>

namespace pcavr {
namespace {

PluginRobotOptions with_text(const std::string& text) {
  return {.text = text, .objects = {"box_1", "box_2"}, .start_timeout = 0.05};
}
std::string faulty(const std::string& fault) {
  return std::string(PCAVR_FAULTY_ROBOT_PLUGINS) + fault + ".so";
}
/// The error message for a plugin that cannot be used.
std::string error_text(const std::filesystem::path& file, const std::string& options = "") {
  const auto robot = make_plugin_robot(file, with_text(options));
  return robot ? "it opened" : robot.error().to_string();
}
bool is_line_with(const std::string& line, const std::string& part) {
  return line.find(part) != std::string::npos && line.find('\n') == std::string::npos;
}
std::string lines(const std::vector<std::string>& notices) {
  std::string text;
  for (const std::string& notice : notices) text += notice + '\n';
  return text;
}

TEST(PluginRobot, RejectsWhatCannotBeUsedWithAOneLineError) {
  EXPECT_PRED2(is_line_with, error_text("/nowhere/robot.so"), "/nowhere/robot.so: does not exist");
  EXPECT_PRED2(is_line_with, error_text(faulty("symbol")), "it lacks pcavr_get_robot_plugin");
  EXPECT_PRED2(is_line_with, error_text(faulty("abi")), "has plugin ABI 2 of");
  EXPECT_PRED2(is_line_with, error_text(faulty("size")), "has plugin ABI 1 of");
  EXPECT_PRED2(is_line_with, error_text(faulty("function")), "lacks one of open, close");
  EXPECT_PRED2(is_line_with, error_text(faulty("null")), "returned no plugin");
  EXPECT_PRED2(is_line_with, error_text(faulty("answers"), "unplugged"), "no robot on the bus");
  EXPECT_PRED2(is_line_with, error_text(faulty("answers"), "blind"),
               "gives no pose of the tool within 0.05 s");
}

/// Advanced for 0.3 s at 1 kHz, with samples that are wrong in the second tenth of a second.
RobotSamples samples_of(const std::string& fault, std::string& notices) {
  auto robot = make_plugin_robot(faulty("answers"), with_text(fault));
  RobotSamples samples;
  EXPECT_TRUE(robot) << robot.error().to_string();
  if (!robot) return samples;
  for (int i = 1; i <= 300; ++i) (*robot)->advance(1e-3 * i, samples);
  notices = lines((*robot)->take_notices());
  return samples;
}

TEST(PluginRobot, IgnoresSamplesThatAreNotValidAndSaysSoOnce) {
  for (const char* const fault : {"nan", "far", "turn", "future", "old"}) {
    std::string notices;
    const RobotSamples samples = samples_of(fault, notices);
    EXPECT_EQ(samples.tool.size(), 200U) << fault;
    EXPECT_EQ(samples.wrench.size(), 300U) << fault;
    EXPECT_EQ(notices, "a sample of the robot's plugin is not valid, and is ignored\n") << fault;
  }
  for (const char* const fault : {"object", "certain"}) {
    std::string notices;
    const RobotSamples samples = samples_of(fault, notices);
    EXPECT_EQ(samples.tracked.size(), 200U) << fault;
    EXPECT_EQ(samples.tool.size(), 300U) << fault;
  }
  std::string notices;
  EXPECT_EQ(samples_of("force", notices).wrench.size(), 200U);
  EXPECT_EQ(samples_of("code", notices).tool.size(), 200U);
  EXPECT_EQ(notices, "the robot's plugin answers -7\n");
}

TEST(PluginRobot, AnExceptionOfThePluginIsAFaultThatIsSaidOnce) {
  EXPECT_PRED2(is_line_with, error_text(faulty("exception"), "open"), "thrown by open");
  auto robot = make_plugin_robot(faulty("exception"), with_text("exchange"));
  ASSERT_TRUE(robot) << robot.error().to_string();
  RobotSamples samples;
  (*robot)->advance(0.05, samples);
  EXPECT_FALSE(samples.has_fault);
  for (int i = 0; i < 100; ++i) (*robot)->advance(0.11 + 1e-3 * i, samples);
  EXPECT_TRUE(samples.has_fault);
  EXPECT_EQ(lines((*robot)->take_notices()), "the robot's plugin throws: thrown by exchange\n");
  auto photographer = make_plugin_robot(faulty("exception"), with_text("picture"));
  ASSERT_TRUE(photographer) << photographer.error().to_string();
  const auto picture = (*photographer)->pictures()->newest(1.0);
  ASSERT_FALSE(picture);
  EXPECT_PRED2(is_line_with, picture.error().to_string(), "the robot's plugin throws");
}

TEST(PluginRobot, StampsSamplesByTheirAge) {
  std::string notices;
  const RobotSamples samples = samples_of("", notices);
  ASSERT_EQ(samples.tracked.size(), 300U);
  EXPECT_NEAR(samples.tool.back().t, 0.3 - 0.001, 1e-12);
  EXPECT_NEAR(samples.wrench.back().t, 0.3 - 0.002, 1e-12);
  EXPECT_NEAR(samples.tracked.back().pose.t, 0.3 - 0.03, 1e-12);
  EXPECT_EQ(samples.tracked.back().object, 1U);
  EXPECT_EQ(notices, "");
}

TEST(PluginRobot, SaysThatTheRobotIsSilent) {
  auto robot = make_plugin_robot(faulty("answers"), with_text("silent"));
  ASSERT_TRUE(robot) << robot.error().to_string();
  RobotSamples samples;
  for (int i = 1; i <= 1000; ++i) (*robot)->advance(1e-3 * i, samples);
  EXPECT_EQ(lines((*robot)->take_notices()), "the robot gives no pose of its tool for 0.2 s\n");
}

TEST(PluginRobot, GivesThePicturesOfItsCamera) {
  auto robot = make_plugin_robot(faulty("answers"), with_text(""));
  ASSERT_TRUE(robot) << robot.error().to_string();
  ASSERT_NE((*robot)->pictures(), nullptr);
  const auto picture = (*robot)->pictures()->newest(1.0);
  ASSERT_TRUE(picture && *picture);
  EXPECT_NEAR((*picture)->t, 0.95, 1e-12);
  ASSERT_EQ((*picture)->image.width(), 2);
  ASSERT_EQ((*picture)->image.height(), 1);
  EXPECT_EQ((*picture)->image(0, 0), (Rgb8{1, 2, 3}));
  EXPECT_EQ((*picture)->image(1, 0), (Rgb8{4, 5, 6}));
  auto dark = make_plugin_robot(faulty("answers"), with_text("dark"));
  ASSERT_TRUE(dark && (*dark)->pictures());
  EXPECT_FALSE((*dark)->pictures()->newest(1.0).value());
  for (const char* const fault : {"wide", "flat", "late", "black"}) {
    auto wrong = make_plugin_robot(faulty("answers"), with_text(fault));
    ASSERT_TRUE(wrong && (*wrong)->pictures());
    const auto none = (*wrong)->pictures()->newest(1.0);
    ASSERT_FALSE(none) << fault;
    EXPECT_PRED2(is_line_with, none.error().to_string(), "one that is not valid") << fault;
  }
  auto earlier = make_plugin_robot(faulty("camera"), with_text(""));
  ASSERT_TRUE(earlier) << earlier.error().to_string();
  EXPECT_EQ((*earlier)->pictures(), nullptr);
}

TEST(PluginRobot, TheSampleFollowsItsSetpointAndFeelsItsTable) {
  auto robot = make_plugin_robot(PCAVR_SAMPLE_ROBOT_PLUGIN, with_text("50"));
  ASSERT_TRUE(robot) << robot.error().to_string();
  EXPECT_EQ((*robot)->name(), "stiff robot");
  EXPECT_TRUE((*robot)->follows_commands());
  const Eigen::Vector3d target(0.3, 0.1, 0.048);
  RobotSamples samples;
  for (int i = 1; i <= 500; ++i) {
    (*robot)->set_command(target, Eigen::Quaterniond::Identity());
    (*robot)->advance(1e-3 * i, samples);
  }
  EXPECT_LT((samples.tool.back().p_base_tip - target).norm(), 1e-6);
  EXPECT_LT((samples.tool.front().p_base_tip - (*robot)->p_base_start()).norm(), 0.02);
  EXPECT_NEAR(samples.wrench.back().force_base.z(), -5000.0 * 0.002, 0.1);
  EXPECT_PRED2(is_line_with, error_text(PCAVR_SAMPLE_ROBOT_PLUGIN, "high"), "is not a height");
  // Its tool ends above the table's edge.
  const CameraPicture picture = (*robot)->pictures()->newest(0.5).value().value();
  const int column = picture.image.width() / 2;
  EXPECT_GT(picture.image(column, 0).r, 150);
  EXPECT_GT(picture.image(column, picture.image.height() - 1).g, 100);
}

}  // namespace
}  // namespace pcavr
