// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/stamp_units.hpp"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

using Kind = StreamPace::Kind;

/// A tool at `rate` [Hz] that moves to and fro at up to `speed` [m/s] for 10 s, written in a unit
/// of which there are `per_second`.
StreamPace tool_at(double rate, double speed, double per_second = 1.0) {
  std::vector<TimedPose> poses;
  const auto rows = static_cast<int>(10.0 * rate);
  for (int i = 0; i < rows; ++i) {
    const double t = i / rate;
    poses.push_back({Stamp::from_seconds(t * per_second),
                     Pose(Eigen::Quaterniond::Identity(), {speed * std::sin(t), 0.0, 0.2})});
  }
  return pace_of("tool.csv", Kind::tool, Trajectory(std::move(poses)));
}

StreamPace stream(const char* name, Kind kind, double rate, double per_second = 1.0,
                  double span = 10.0) {
  return {.name = name,
          .kind = kind,
          .rows = static_cast<std::size_t>(span * rate),
          .interval = per_second / rate,
          .span = span * per_second};
}

StreamPace force_at(double rate, double per_second = 1.0) {
  return stream("wrench.csv", Kind::force, rate, per_second);
}
StreamPace frames_at(double rate, double per_second = 1.0, double span = 10.0) {
  return stream("depth.txt", Kind::frames, rate, per_second, span);
}

bool names(const std::vector<std::string>& warnings, const std::string& text) {
  return warnings.size() == 1 && warnings[0].find(text) != std::string::npos;
}

TEST(StampUnits, NamesMillisecondsOfAllStreams) {
  for (const double rate : {50.0, 125.0, 500.0, 1000.0}) {
    const auto warnings = doubtful_stamp_units(
        {tool_at(rate, 0.25, 1e3), force_at(500.0, 1e3), frames_at(30.0, 1e3)});
    EXPECT_TRUE(names(warnings, "tool.csv: the stamps may be in milliseconds")) << rate;
  }
  EXPECT_TRUE(names(doubtful_stamp_units({tool_at(500.0, 0.25, 1e3)}), "milliseconds"));
}

TEST(StampUnits, NamesTicksOfTenMilliseconds) {
  EXPECT_TRUE(names(
      doubtful_stamp_units({tool_at(500.0, 0.3, 1e2), force_at(500.0, 1e2), frames_at(30.0, 1e2)}),
      "hundredths of a second: 5 rows a second of a tool that moves at 3 mm/s"));
}

TEST(StampUnits, NamesTheStreamOfAnotherUnit) {
  EXPECT_TRUE(names(doubtful_stamp_units({tool_at(500.0, 0.25), force_at(500.0, 1e3)}),
                    "wrench.csv: the stamps are probably in milliseconds"));
  EXPECT_TRUE(names(doubtful_stamp_units({tool_at(500.0, 0.25), frames_at(30.0, 1e3)}),
                    "depth.txt: the stamps are probably in milliseconds: one row in 33.3 s"));
  EXPECT_TRUE(names(doubtful_stamp_units({tool_at(125.0, 0.25, 1e3), force_at(500.0)}),
                    "tool.csv: the stamps are probably in milliseconds"));
  EXPECT_TRUE(names(doubtful_stamp_units({tool_at(125.0, 0.25), force_at(500.0, 1e6)}),
                    "wrench.csv: the stamps are probably in microseconds"));
}

TEST(StampUnits, SlowRecordingsAreSound) {
  // A tool at 10 Hz and a camera at 1 Hz.
  EXPECT_TRUE(doubtful_stamp_units({tool_at(10.0, 0.25), force_at(10.0), frames_at(1.0)}).empty());
  EXPECT_TRUE(doubtful_stamp_units({tool_at(5.0, 0.1), force_at(5.0), frames_at(0.5)}).empty());
  // A slow push under fast sensors, and one that is logged slowly beside a fast camera.
  EXPECT_TRUE(doubtful_stamp_units({tool_at(30.0, 0.002), force_at(100.0)}).empty());
  EXPECT_TRUE(doubtful_stamp_units({tool_at(5.0, 0.003), force_at(100.0)}).empty());
  EXPECT_TRUE(doubtful_stamp_units({tool_at(5.0, 0.003), force_at(5.0), frames_at(1.0)}).empty());
  // A picture every ten seconds for an hour, with ten seconds of a push.
  EXPECT_TRUE(doubtful_stamp_units({tool_at(500.0, 0.25), frames_at(0.1, 1.0, 3600.0)}).empty());
  // A tool at rest.
  EXPECT_TRUE(doubtful_stamp_units({tool_at(5.0, 1e-4), force_at(5.0)}).empty());
  EXPECT_TRUE(doubtful_stamp_units({}).empty());
}

TEST(StampUnits, NamesTheUnitOfAnInterval) {
  EXPECT_EQ(unit_of_interval(2.0), "milliseconds");
  EXPECT_EQ(unit_of_interval(0.2), "hundredths of a second");
  EXPECT_EQ(unit_of_interval(33e3), "microseconds");
  EXPECT_EQ(unit_of_interval(2e6), "nanoseconds");
}

}  // namespace
}  // namespace pcavr
