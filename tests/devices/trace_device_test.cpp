// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/devices/trace_device.hpp"

#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"

#include "fuzz/targets.hpp"
#include "support/source_folder.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

constexpr double kCycle = 0.001;  // [s]

std::vector<TraceSample> parsed(std::string_view text) {
  const auto samples = parse_trace(text, "trace");
  EXPECT_TRUE(samples) << samples.error().to_string();
  return samples ? *samples : std::vector<TraceSample>();
}

std::string error_text(std::string_view text) {
  const auto samples = parse_trace(text, "trace");
  return samples ? "it was read" : samples.error().to_string();
}

TEST(ParseTrace, ReadsAToolFileOfARecording) {
  const auto samples = parsed("t,x,y,z,qx,qy,qz,qw\n5.5,1,2,3,0,0,0,1\n6.0,1.5,2,3,0,0,1,0\n");
  ASSERT_EQ(samples.size(), 2u);
  EXPECT_EQ(samples[0].t, 0.0);
  EXPECT_EQ(samples[1].t, 0.5);
  EXPECT_EQ(samples[1].p_base_tip, Eigen::Vector3d(1.5, 2.0, 3.0));
  EXPECT_EQ(samples[1].q_base_tool.z(), 1.0);
  EXPECT_TRUE(samples[1].is_engaged);
}

TEST(ParseTrace, ReadsATrajectory) {
  const auto samples =
      parsed("# t x y z qx qy qz qw\n\n1 1 2 3 0 0 0 1 # at rest\n2 1 2 3 0 0 0 1");
  ASSERT_EQ(samples.size(), 2u);
  EXPECT_EQ(samples[1].t, 1.0);
}

TEST(ParseTrace, ReadsPositionsWithOptionalClutch) {
  EXPECT_EQ(parsed("t,x,y,z\n0,1,2,3\n").size(), 1u);
  const auto samples = parsed("t,x,y,z,engaged\r\n0,1,2,3,0\r\n1,1,2,3,1\r\n");
  ASSERT_EQ(samples.size(), 2u);
  EXPECT_FALSE(samples[0].is_engaged);
  EXPECT_TRUE(samples[1].is_engaged);
  EXPECT_FALSE(parsed("t,x,y,z,qx,qy,qz,qw,engaged\n0,1,2,3,0,0,0,1,0\n")[0].is_engaged);
}

TEST(ParseTrace, ReportsErrorsWithTheirLine) {
  EXPECT_EQ(error_text(""), "trace: has no rows; write one per sample: t,x,y,z");
  EXPECT_NE(error_text("t,x,y,z\n").find("trace: has no rows"), std::string::npos);
  EXPECT_NE(error_text("t,x,z,y\n0,1,2,3\n").find("trace:1: has an unexpected header"),
            std::string::npos);
  EXPECT_NE(error_text("t,x,y,z,engaged,qx\n0,1,2,3,0,0\n").find("has an unexpected header"),
            std::string::npos);
  EXPECT_NE(error_text("t,x,y,z\n0,1,2\n").find("trace:2: has 3 columns, not 4"),
            std::string::npos);
  EXPECT_NE(error_text("t,x,y,z\n0,1,2,nan\n").find("trace:2: z: 'nan' is not a finite number"),
            std::string::npos);
  EXPECT_NE(error_text("t,x,y,z\n0,1,2,3\n0,1,2,3\n").find("trace:3: time 0 is not after"),
            std::string::npos);
  EXPECT_NE(error_text("t,x,y,z\n0,1,2,101\n").find("trace:2: lies more than 100 m"),
            std::string::npos);
  EXPECT_NE(error_text("t,x,y,z,engaged\n0,1,2,3,2\n").find("trace:2: engaged: is neither 0 nor 1"),
            std::string::npos);
  EXPECT_NE(error_text("0 1 2 3 0 0 0 7\n").find("trace:1:"), std::string::npos);
  EXPECT_NE(error_text("0 1 2 3\n").find("trace:1: has 4 columns, not 8"), std::string::npos);
}

TEST(ParseTrace, PassesTheFuzzersChecks) {
  const auto folder = source_folder() / "tests/fuzz/corpus/trace";
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const auto bytes = read_file(entry.path());
    ASSERT_TRUE(bytes);
    EXPECT_NO_THROW(fuzz::trace(*bytes)) << entry.path();
    // The file is truncated at every byte, too.
    for (std::size_t i = 0; i < bytes->size(); ++i) {
      EXPECT_NO_THROW(fuzz::trace(std::string_view(*bytes).substr(0, i))) << entry.path() << i;
    }
    ++files;
  }
  EXPECT_GE(files, 5);
}

TEST(TraceDevice, InterpolatesBetweenRows) {
  TraceDevice device(
      parsed("t,x,y,z,qx,qy,qz,qw\n"
             "10,0.1,0,0,0,0,0,1\n11,0.2,0,0,0,0,1,0\n13,0.2,0.4,0,0,0,1,0\n"));
  EXPECT_EQ(device.duration(), 3.0);
  const DeviceFeedback feedback{.p_base_tool = {0.1, 0.0, 0.0}};
  for (int i = 0; i <= 3000; ++i) {
    // The world's clock has an arbitrary origin.
    const DeviceSample sample = device.exchange(500.0 + i * kCycle, kCycle, feedback);
    const double t = i * kCycle;
    const Eigen::Vector3d truth(0.1 + 0.1 * std::min(t, 1.0), 0.2 * std::max(t - 1.0, 0.0), 0.0);
    ASSERT_TRUE(sample.is_engaged) << i;
    EXPECT_LT((sample.p_base_tip - truth).norm(), 1e-9);
    EXPECT_NEAR(sample.q_base_tool.angularDistance(Eigen::Quaterniond::Identity()),
                M_PI * std::min(t, 1.0), 1e-6);
  }
}

TEST(TraceDevice, EndsDisengagedAndAbsent) {
  TraceDevice device(parsed("t,x,y,z\n0,0,0,0\n1,0,0,0\n"));
  EXPECT_TRUE(device.exchange(7.0, kCycle, {}).is_present);
  EXPECT_TRUE(device.exchange(8.0, kCycle, {}).is_engaged);
  const DeviceSample sample = device.exchange(8.001, kCycle, {});
  EXPECT_FALSE(sample.is_present);
  EXPECT_FALSE(sample.is_engaged);
}

TEST(TraceDevice, ApproachesItsStartWithoutAJump) {
  TraceDevice device(parsed("t,x,y,z\n0,1,0,0\n10,1,0,0\n"));
  DeviceFeedback feedback{.p_base_tool = {0.0, 0.0, 0.0}};
  int cycles = 0;
  for (; cycles < 10'000 && (feedback.p_base_tool.x() < 1.0); ++cycles) {
    const DeviceSample sample = device.exchange(cycles * kCycle, kCycle, feedback);
    ASSERT_LE((sample.p_base_tip - feedback.p_base_tool).norm(), 2.0 * kCycle + 1e-12);
    feedback.p_base_tool = sample.p_base_tip;
  }
  // A metre at 2 m/s; rounding may add a cycle.
  EXPECT_NEAR(cycles, 500, 1);
}

TEST(TraceDevice, OpensTheClutchAsInTheTrace) {
  TraceDevice device(parsed("t,x,y,z,engaged\n0,0,0,0,1\n0.1,0,0,0,0\n0.2,0,0,0,1\n0.3,0,0,0,1\n"));
  EXPECT_TRUE(device.exchange(0.0, kCycle, {}).is_engaged);
  const DeviceSample open = device.exchange(0.15, kCycle, {});
  EXPECT_FALSE(open.is_engaged);
  EXPECT_TRUE(open.is_present);
  EXPECT_TRUE(device.exchange(0.25, kCycle, {}).is_engaged);
}

TEST(TraceDevice, ReportsTheInvalidFile) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "tool.csv";
  ASSERT_TRUE(write_file(file, "t,x,y,z\n0,0,0,0\n0,0,0,0\n"));
  const auto device = TraceDevice::open(file);
  ASSERT_FALSE(device);
  EXPECT_EQ(device.error().file, file.string());
  EXPECT_EQ(device.error().line, 3);
  EXPECT_FALSE(device.error().hint.empty());
}

}  // namespace
}  // namespace pcavr
