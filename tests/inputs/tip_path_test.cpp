// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/inputs/tip_path.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

/// A tip that moves at `speed` [m/s] along x for two seconds, sampled at 500 Hz, without noise.
struct Motion {
  explicit Motion(double speed) {
    for (int i = 0; i < 1000; ++i) {
      t.push_back(0.002 * i);
      p.emplace_back(speed * t.back(), 0.0, 0.0);
    }
  }
  [[nodiscard]] TipPath cleaned() const { return clean_tip_path(t, p, InputOptions{}); }

  std::vector<double> t;
  std::vector<Eigen::Vector3d> p;
};

TEST(TipPath, KeepsAllSamplesOfASoundTool) {
  const Motion motion(0.05);
  const TipPath path = motion.cleaned();
  EXPECT_EQ(path.t.size(), motion.t.size());
  EXPECT_EQ(path.outliers, 0U);
  EXPECT_TRUE(path.jumps.empty());
  EXPECT_TRUE(path.bad.empty());
}

TEST(TipPath, TakesTwoStampsCloseToEachOtherForJitter) {
  Motion motion(0.0);
  // The driver repeats each position five times; then the tip has moved by 0.04 mm. One sample came
  // late, 0.15 ms before the next one, which has a new position.
  for (std::size_t i = 0; i < motion.p.size(); ++i) {
    motion.p[i].x() = 4e-5 * static_cast<double>(i / 5);
  }
  motion.t[499] = motion.t[500] - 0.00015;
  const TipPath path = motion.cleaned();
  EXPECT_TRUE(path.jumps.empty());
  EXPECT_TRUE(path.bad.empty());
  EXPECT_EQ(path.outliers, 0U);
}

TEST(TipPath, TakesJitterDuringFastMotionForJitter) {
  Motion motion(0.5);
  for (std::size_t i = 100; i + 1 < motion.t.size(); i += 50) {
    motion.t[i] = motion.t[i + 1] - 0.00015;
  }
  const TipPath path = motion.cleaned();
  EXPECT_TRUE(path.jumps.empty());
  EXPECT_TRUE(path.bad.empty());
}

TEST(TipPath, RejectsSpikesAndBridgesThem) {
  Motion motion(0.02);
  motion.p[300] += Eigen::Vector3d(0.0, 0.01, 0.0);
  motion.p[700] += Eigen::Vector3d(0.3, 0.0, 0.0);
  const TipPath path = motion.cleaned();
  EXPECT_EQ(path.outliers, 2U);
  EXPECT_DOUBLE_EQ(path.first_outlier, motion.t[300]);
  EXPECT_TRUE(path.jumps.empty());
  EXPECT_TRUE(path.bad.empty()) << "contacts remain usable";
  EXPECT_LT((path.at(motion.t[300]) - Eigen::Vector3d(0.012, 0.0, 0.0)).norm(), 1e-9);
}

TEST(TipPath, KeepsAShortPressOfASlowlySampledTool) {
  // The path at 10 Hz: rest, 15 mm down and up again within one sample, and a start at 0.25 m/s.
  std::vector<double> t;
  std::vector<Eigen::Vector3d> p;
  for (int i = 0; i < 60; ++i) {
    t.push_back(0.1 * i);
    const double noise = i % 2 == 0 ? 1e-5 : -1e-5;
    p.emplace_back(-0.025 * std::max(0, 2 - i), noise, i == 30 ? -0.015 : 0.0);
  }
  const TipPath path = clean_tip_path(t, p, InputOptions{});
  EXPECT_EQ(path.outliers, 0U);
  EXPECT_EQ(path.p_base[30].z(), -0.015);
}

TEST(TipPath, RejectsDropoutsAndReportsTheirTime) {
  Motion motion(0.02);
  for (std::size_t i = 300; i < 320; ++i) motion.p[i] += Eigen::Vector3d(0.4, 0.3, 0.0);
  const TipPath path = motion.cleaned();
  EXPECT_EQ(path.outliers, 20U);
  EXPECT_TRUE(path.jumps.empty());
  ASSERT_EQ(path.bad.size(), 1U);
  EXPECT_LT(path.bad[0].begin, motion.t[300]);
  EXPECT_GT(path.bad[0].end, motion.t[319]);
}

TEST(TipPath, ReportsAJumpToAPlaceWhereTheTipStays) {
  Motion motion(0.02);
  for (std::size_t i = 500; i < motion.p.size(); ++i) motion.p[i].y() += 0.004;
  const TipPath path = motion.cleaned();
  ASSERT_EQ(path.jumps.size(), 1U);
  EXPECT_NEAR(path.jumps[0], motion.t[500], 0.002);
  ASSERT_EQ(path.bad.size(), 1U);
  EXPECT_EQ(path.t.size(), motion.t.size());
}

TEST(TipPath, OfNoSampleIsEmpty) {
  const TipPath path = clean_tip_path({}, {}, InputOptions{});
  EXPECT_TRUE(path.t.empty());
  EXPECT_TRUE(path.bad.empty());
}

}  // namespace
}  // namespace pcavr
