// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/held_samples.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <random>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

constexpr double kRowPeriod = 0.002;  // [s]

Stamp stamp_of_row(std::size_t row) {
  return Stamp::from_seconds(kRowPeriod * static_cast<double>(row));
}

/// A tool along x, whose position at a row is `x`.
Trajectory tool_along(std::size_t rows, const std::function<double(std::size_t)>& x) {
  Trajectory tool;
  for (std::size_t i = 0; i < rows; ++i) {
    tool.append(stamp_of_row(i), Pose(Eigen::Quaterniond::Identity(), {x(i), 0.1, 0.2}));
  }
  return tool;
}

/// Each value of a noisy force stands for as many rows as `rows_of` says of it.
std::vector<WrenchSample> held_force(std::size_t values,
                                     const std::function<std::size_t(std::size_t)>& rows_of) {
  std::vector<WrenchSample> wrench;
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, 0.05);
  for (std::size_t i = 0; i < values; ++i) {
    const Eigen::Vector3d force(noise(random), noise(random), noise(random));
    for (std::size_t k = 0; k < rows_of(i); ++k) {
      wrench.push_back({stamp_of_row(wrench.size()), force, Eigen::Vector3d::Zero()});
    }
  }
  return wrench;
}

/// [m] Position at time t [s]: a stroke of 50 mm each second, and a rest of a second, without
/// noise.
double stroke(double t) {
  constexpr double kPi = 3.14159265358979;
  const double phase = std::min(1.0, std::fmod(t, 2.0));
  const double there = 0.025 * (1.0 - std::cos(kPi * phase));
  return std::fmod(t, 4.0) < 2.0 ? there : 0.05 - there;
}

TEST(HeldSamples, LeavesOutRepeatsOfEachValue) {
  for (const std::size_t hold :
       {std::size_t{2}, std::size_t{3}, std::size_t{10}, std::size_t{20}}) {
    std::vector<WrenchSample> wrench = held_force(100, [&](std::size_t) { return hold; });
    const std::vector<WrenchSample> all = wrench;
    const auto note = leave_out_held("wrench.csv", wrench);
    ASSERT_TRUE(note) << hold;
    ASSERT_EQ(wrench.size(), 100U) << hold;
    for (std::size_t i = 0; i < wrench.size(); ++i) {
      EXPECT_EQ(wrench[i].stamp, all[hold * i].stamp);
      EXPECT_EQ(wrench[i].force, all[hold * i].force);
    }
  }
}

TEST(HeldSamples, NoteNamesStreamAndRates) {
  std::vector<WrenchSample> wrench = held_force(100, [](std::size_t) { return std::size_t{10}; });
  const auto note = leave_out_held("wrench.csv", wrench);
  ASSERT_TRUE(note);
  EXPECT_EQ(*note,
            "wrench.csv: each value stands for 10 rows: 500 rows a second hold 50 values a second; "
            "900 of 1000 rows, which repeat the row before, are left out");
}

TEST(HeldSamples, ReadsTwoClocksOutOfStep) {
  // 200 values a second in 500 rows a second: 2 or 3 rows each.
  std::vector<WrenchSample> wrench = held_force(200, [](std::size_t i) { return 2 + i % 2; });
  ASSERT_TRUE(leave_out_held("wrench.csv", wrench));
  EXPECT_EQ(wrench.size(), 200U);
  // A loop that is not in real time: 8 rows, more or less.
  std::mt19937 random(3);
  std::uniform_int_distribution<std::size_t> jitter(7, 9);
  wrench = held_force(200, [&](std::size_t) { return jitter(random); });
  ASSERT_TRUE(leave_out_held("wrench.csv", wrench));
  EXPECT_EQ(wrench.size(), 200U);
}

TEST(HeldSamples, KeepsOneRowForEachPeriodOfARest) {
  Trajectory tool =
      tool_along(4000, [](std::size_t i) { return stroke(4.0 * kRowPeriod * double(i / 4)); });
  ASSERT_TRUE(leave_out_held("tool.csv", tool));
  EXPECT_EQ(tool.size(), 1000U);
  for (std::size_t i = 1; i < tool.size(); ++i) {
    EXPECT_EQ(to_seconds(tool.poses()[i].stamp - tool.poses()[i - 1].stamp), 4.0 * kRowPeriod);
  }
}

TEST(HeldSamples, RestWithoutNoiseIsSound) {
  Trajectory tool = tool_along(4000, [](std::size_t i) { return stroke(kRowPeriod * double(i)); });
  EXPECT_FALSE(leave_out_held("tool.csv", tool));
  EXPECT_EQ(tool.size(), 4000U);
  Trajectory still = tool_along(4000, [](std::size_t) { return 0.3; });
  EXPECT_FALSE(leave_out_held("tool.csv", still));
  EXPECT_EQ(still.size(), 4000U);
}

TEST(HeldSamples, SlowMotionOfCoarseResolutionIsSound) {
  constexpr double kResolution = 1e-4;  // [m]
  for (const double speed : {0.002, 0.005, 0.0123}) {
    Trajectory tool = tool_along(5000, [&](std::size_t i) {
      return kResolution * std::floor(speed * kRowPeriod * double(i) / kResolution);
    });
    EXPECT_FALSE(leave_out_held("tool.csv", tool)) << speed;
    EXPECT_EQ(tool.size(), 5000U);
  }
}

TEST(HeldSamples, NoiseBelowTheResolutionIsSound) {
  std::mt19937 random(11);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::vector<WrenchSample> wrench;
  for (std::size_t i = 0; i < 5000; ++i) {
    const double force = 0.1 * std::round(0.6 * noise(random));
    wrench.push_back({stamp_of_row(i), {force, 0.0, 0.0}, Eigen::Vector3d::Zero()});
  }
  EXPECT_FALSE(leave_out_held("wrench.csv", wrench));
  EXPECT_EQ(wrench.size(), 5000U);
}

}  // namespace
}  // namespace pcavr
