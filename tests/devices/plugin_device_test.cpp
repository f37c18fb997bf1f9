// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/devices/plugin_device.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"

#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

constexpr double kCycle = 0.001;  // [s]
const DeviceFeedback kFeedback{.p_base_tool = {0.5, 0.1, 0.2}};

std::string faulty(const std::string& fault) {
  return std::string(PCAVR_FAULTY_PLUGINS) + fault + ".so";
}

PluginDeviceOptions with_text(const std::string& text) {
  PluginDeviceOptions options;
  options.text = text;
  return options;
}

/// The error message for a plugin that cannot be used.
std::string error_text(const std::filesystem::path& file, const std::string& options = "") {
  const auto device = PluginDevice::open(file, with_text(options));
  return device ? "it opened" : device.error().to_string();
}

bool is_line_with(const std::string& line, const std::string& part) {
  return line.find(part) != std::string::npos && line.find('\n') == std::string::npos;
}

TEST(PluginDevice, RejectsWhatCannotBeLoadedWithAOneLineError) {
  const TemporaryFolder folder;
  const auto text = folder.path() / "text.so";
  ASSERT_TRUE(write_file(text, "not a library"));
  EXPECT_PRED2(is_line_with, error_text("/nowhere/device.so"),
               "/nowhere/device.so: does not exist");
  EXPECT_PRED2(is_line_with, error_text(text), "can't be loaded as a library");
  EXPECT_PRED2(is_line_with, error_text(folder.path()), "can't be loaded as a library");
  EXPECT_PRED2(is_line_with, error_text(faulty("symbol")), "it lacks pcavr_get_device_plugin");
}

TEST(PluginDevice, RejectsAnotherAbiAndIncompletePlugins) {
  EXPECT_PRED2(is_line_with, error_text(faulty("abi")), "has plugin ABI 2 of");
  EXPECT_PRED2(is_line_with, error_text(faulty("size")), "has plugin ABI 1 of");
  EXPECT_PRED2(is_line_with, error_text(faulty("null")), "returned no plugin");
  EXPECT_PRED2(is_line_with, error_text(faulty("function")),
               "lacks one of open, close and exchange");
}

TEST(PluginDevice, ReportsWhyADeviceDoesNotOpen) {
  EXPECT_PRED2(is_line_with, error_text(faulty("answers"), "unplugged"), "no device on the bus");
  EXPECT_PRED2(is_line_with, error_text(faulty("answers"), "mute"), "no reason given");
  // A text without terminating zero is cut at the buffer's end.
  EXPECT_PRED2(is_line_with, error_text(faulty("answers"), "long"), std::string(255, 'x'));
}

TEST(PluginDevice, AnEmergencyStopCountsEvenIfTheTipIsRejected) {
  auto device = PluginDevice::open(faulty("answers"), with_text("nan"));
  ASSERT_TRUE(device) << device.error().to_string();
  for (int i = 0; i < 200; ++i) {
    EXPECT_EQ((*device)->exchange(i * kCycle, kCycle, kFeedback).is_stop_pressed, i == 150) << i;
  }
}

class InvalidSamples : public testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(PluginDevice, InvalidSamples,
                         testing::Values("nan", "far", "turn", "code", "away"));

TEST_P(InvalidSamples, MakeItAbsentMeanwhileWithoutAJump) {
  auto device = PluginDevice::open(faulty("answers"), with_text(GetParam()));
  ASSERT_TRUE(device) << device.error().to_string();
  DeviceFeedback feedback = kFeedback;
  for (int i = 0; i < 300; ++i) {
    const DeviceSample sample = (*device)->exchange(i * kCycle, kCycle, feedback);
    EXPECT_EQ(sample.is_present, i < 100 || i >= 200) << i;
    EXPECT_EQ(sample.is_engaged, sample.is_present) << i;
    EXPECT_TRUE(sample.p_base_tip.allFinite());
    if (!sample.is_engaged) continue;
    EXPECT_LT((sample.p_base_tip - feedback.p_base_tool).norm(), 0.11 * kCycle);
    feedback.p_base_tool = sample.p_base_tip;
  }
  const bool is_fault = std::string(GetParam()) != "away";
  EXPECT_EQ((*device)->health().faults, is_fault ? 100u : 0u);
  EXPECT_GT((*device)->health().slowest, 0.0);
}

TEST(PluginDevice, SurvivesAnExceptionOfThePlugin) {
  auto device = PluginDevice::open(faulty("exception"));
  ASSERT_TRUE(device) << device.error().to_string();
  EXPECT_EQ((*device)->name(), "plugin");
  EXPECT_FALSE((*device)->exchange(0.0, kCycle, kFeedback).is_present);
  EXPECT_EQ((*device)->health().faults, 1u);
}

TEST(PluginDevice, DoesNotEngageAtAnInvalidToolPosition) {
  auto device = PluginDevice::open(faulty("answers"));
  ASSERT_TRUE(device) << device.error().to_string();
  const DeviceFeedback nowhere{
      .p_base_tool = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN())};
  const DeviceSample sample = (*device)->exchange(0.0, kCycle, nowhere);
  EXPECT_FALSE(sample.is_engaged);
  EXPECT_TRUE(sample.p_base_tip.allFinite());
}

#ifdef PCAVR_SAMPLE_PLUGIN

TEST(SamplePlugin, MovesTheToolOnACircleOfTheGivenRadius) {
  auto device = PluginDevice::open(PCAVR_SAMPLE_PLUGIN, with_text("50"));
  ASSERT_TRUE(device) << device.error().to_string();
  EXPECT_EQ((*device)->name(), "round device");
  Eigen::Vector3d min = Eigen::Vector3d::Constant(1e9);
  Eigen::Vector3d max = -min;
  for (int i = 0; i < 14'000; ++i) {
    const DeviceSample sample = (*device)->exchange(i * kCycle, kCycle, kFeedback);
    ASSERT_TRUE(sample.is_engaged);
    if (i < 1000) continue;
    min = min.cwiseMin(sample.p_base_tip);
    max = max.cwiseMax(sample.p_base_tip);
  }
  // The spring causes a lag of a twentieth of a radian, and a smaller radius by a thousandth.
  EXPECT_NEAR((max - min).x(), 0.1, 5e-4);
  EXPECT_NEAR((max - min).y(), 0.1, 5e-4);
  EXPECT_EQ((max - min).z(), 0.0);
  EXPECT_EQ((*device)->health().faults, 0u);
}

TEST(SamplePlugin, AppliesTheForceInTheOperatorsFrame) {
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

TEST(SamplePlugin, AppliesTheTorqueInTheOperatorsFrame) {
  PluginDeviceOptions options;
  options.facing = M_PI / 2.0;
  auto device = PluginDevice::open(PCAVR_SAMPLE_PLUGIN, options);
  ASSERT_TRUE(device);
  DeviceFeedback feedback = kFeedback;
  feedback.torque_base = {0.0, 0.02, 0.0};
  DeviceSample sample;
  for (int i = 0; i < 1000; ++i) sample = (*device)->exchange(i * kCycle, kCycle, feedback);
  // Its spring has 0.5 N m/rad: 0.04 rad about base y, after the operator's own direction.
  const Eigen::AngleAxisd tilt(sample.q_base_tool *
                               Eigen::AngleAxisd(-options.facing, Eigen::Vector3d::UnitZ()));
  EXPECT_LT((tilt.angle() * tilt.axis() - Eigen::Vector3d(0.0, 0.04, 0.0)).norm(), 1e-4);
}

TEST(SamplePlugin, ReportsInvalidOptions) {
  EXPECT_PRED2(is_line_with, error_text(PCAVR_SAMPLE_PLUGIN, "-1"),
               "'-1' is not a radius from 0 to 100 mm");
}

#endif

}  // namespace
}  // namespace pcavr
