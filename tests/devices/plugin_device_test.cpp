// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/devices/plugin_device.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "pcavr/core/output.hpp"

#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

constexpr double kCycle = 0.001;  // [s]
const DeviceFeedback kFeedback{.p_base_tool = {0.5, 0.1, 0.2}};

std::string faulty(const std::string& fault) {
  return std::string(PCAVR_FAULTY_PLUGINS) + fault + ".so";
}

/// What is said about a plugin that cannot be used.
std::string complaint(const std::filesystem::path& file, const std::string& options = "") {
  const auto device = PluginDevice::open(file, {.text = options});
  return device ? "it opened" : device.error().to_string();
}

bool says(const std::string& line, const std::string& words) {
  return line.find(words) != std::string::npos && line.find('\n') == std::string::npos;
}

TEST(PluginDevice, RefusesWhatCannotBeLoadedInOneClearLine) {
  const TemporaryFolder folder;
  const auto text = folder.path() / "text.so";
  ASSERT_TRUE(write_file(text, "not a library"));
  EXPECT_PRED2(says, complaint("/nowhere/device.so"), "/nowhere/device.so: does not exist");
  EXPECT_PRED2(says, complaint(text), "is no library that can be loaded");
  EXPECT_PRED2(says, complaint(folder.path()), "is no library that can be loaded");
  EXPECT_PRED2(says, complaint(faulty("symbol")), "it lacks pcavr_get_device_plugin");
}

TEST(PluginDevice, RefusesAnotherAbiAndWhatIsNotWhole) {
  EXPECT_PRED2(says, complaint(faulty("abi")), "has plugin ABI 2 of");
  EXPECT_PRED2(says, complaint(faulty("size")), "has plugin ABI 1 of");
  EXPECT_PRED2(says, complaint(faulty("null")), "gives no plugin");
  EXPECT_PRED2(says, complaint(faulty("function")), "lacks one of open, close and exchange");
}

TEST(PluginDevice, SaysWhyADeviceDoesNotOpen) {
  EXPECT_PRED2(says, complaint(faulty("answers"), "unplugged"), "no device on the bus");
  EXPECT_PRED2(says, complaint(faulty("answers"), "mute"), "it does not say why");
  // A text without its zero is cut at the buffer's end.
  EXPECT_PRED2(says, complaint(faulty("answers"), "long"), std::string(255, 'x'));
}

class WrongAnswers : public testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(PluginDevice, WrongAnswers,
                         testing::Values("nan", "far", "turn", "code", "away"));

TEST_P(WrongAnswers, MakeItAbsentForAsLongAsTheyLastAndLeaveNoJump) {
  auto device = PluginDevice::open(faulty("answers"), {.text = GetParam()});
  ASSERT_TRUE(device) << device.error().to_string();
  DeviceFeedback feedback = kFeedback;
  for (int i = 0; i < 300; ++i) {
    const DeviceSample said = (*device)->exchange(i * kCycle, kCycle, feedback);
    EXPECT_EQ(said.is_present, i < 100 || i >= 200) << i;
    EXPECT_EQ(said.is_engaged, said.is_present) << i;
    EXPECT_TRUE(said.p_base_tip.allFinite());
    if (!said.is_engaged) continue;
    EXPECT_LT((said.p_base_tip - feedback.p_base_tool).norm(), 0.11 * kCycle);
    feedback.p_base_tool = said.p_base_tip;
  }
  const bool is_fault = std::string(GetParam()) != "away";
  EXPECT_EQ((*device)->health().faults, is_fault ? 100u : 0u);
  EXPECT_GT((*device)->health().slowest, 0.0);
}

TEST(PluginDevice, OutlivesAnExceptionOfThePlugins) {
  auto device = PluginDevice::open(faulty("exception"));
  ASSERT_TRUE(device) << device.error().to_string();
  EXPECT_EQ((*device)->name(), "plugin");
  EXPECT_FALSE((*device)->exchange(0.0, kCycle, kFeedback).is_present);
  EXPECT_EQ((*device)->health().faults, 1u);
}

TEST(PluginDevice, DoesNotCloseOnAToolThatIsNowhere) {
  auto device = PluginDevice::open(faulty("answers"));
  ASSERT_TRUE(device) << device.error().to_string();
  const DeviceFeedback nowhere{
      .p_base_tool = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN())};
  const DeviceSample said = (*device)->exchange(0.0, kCycle, nowhere);
  EXPECT_FALSE(said.is_engaged);
  EXPECT_TRUE(said.p_base_tip.allFinite());
}

#ifdef PCAVR_SAMPLE_PLUGIN

TEST(SamplePlugin, LeadsTheToolRoundACircleOfTheRadiusAskedFor) {
  auto device = PluginDevice::open(PCAVR_SAMPLE_PLUGIN, {.text = "50"});
  ASSERT_TRUE(device) << device.error().to_string();
  EXPECT_EQ((*device)->name(), "round device");
  Eigen::Vector3d least = Eigen::Vector3d::Constant(1e9);
  Eigen::Vector3d most = -least;
  for (int i = 0; i < 14'000; ++i) {
    const DeviceSample said = (*device)->exchange(i * kCycle, kCycle, kFeedback);
    ASSERT_TRUE(said.is_engaged);
    if (i < 1000) continue;
    least = least.cwiseMin(said.p_base_tip);
    most = most.cwiseMax(said.p_base_tip);
  }
  // The spring lets it lag by a twentieth of a radian, and shrink by a thousandth.
  EXPECT_NEAR((most - least).x(), 0.1, 5e-4);
  EXPECT_NEAR((most - least).y(), 0.1, 5e-4);
  EXPECT_EQ((most - least).z(), 0.0);
  EXPECT_EQ((*device)->health().faults, 0u);
}

TEST(SamplePlugin, IsPushedByTheForceInTheDirectionThatTheOperatorFaces) {
  PluginDeviceOptions options;
  options.facing = M_PI / 2.0;
  auto device = PluginDevice::open(PCAVR_SAMPLE_PLUGIN, options);
  auto unpushed = PluginDevice::open(PCAVR_SAMPLE_PLUGIN, options);
  ASSERT_TRUE(device && unpushed);
  DeviceFeedback feedback = kFeedback;
  feedback.force_base = {0.0, 2.0, -1.0};
  Eigen::Vector3d difference;
  for (int i = 0; i < 2000; ++i) {
    difference = (*device)->exchange(i * kCycle, kCycle, feedback).p_base_tip -
                 (*unpushed)->exchange(i * kCycle, kCycle, kFeedback).p_base_tip;
  }
  // Its spring has 200 N/m.
  EXPECT_LT((difference - Eigen::Vector3d(0.0, 0.01, -0.005)).norm(), 1e-6);
}

TEST(SamplePlugin, SaysWhatItsOptionsMayBe) {
  EXPECT_PRED2(says, complaint(PCAVR_SAMPLE_PLUGIN, "-1"), "'-1' is no radius from 0 to 100 mm");
}

#endif

}  // namespace
}  // namespace pcavr
