// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/calibration/touched_points.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "calibration/random_rig.hpp"
#include "support/std_coverage.hpp"

namespace pcavr {
namespace {

struct TouchRig {
  Pose T_base_world;
  std::vector<TouchedPoint> points;

  TouchRig(std::uint64_t seed, int count, double noise) {
    Random random(seed);
    Vector6d twist;
    twist << normal_vector(random, 0.5), normal_vector(random, 1.0);
    T_base_world = Pose::exp(twist);
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector3d p = Eigen::Vector3d(1.0, 0.5, 0.0) + normal_vector(random, 0.3);
      points.push_back(
          {"point " + std::to_string(i + 1), p, T_base_world * p + normal_vector(random, noise)});
    }
  }
};

TEST(CalibrateTouch, PlacesTheWorldByThreePointsWithoutNoise) {
  const TouchRig rig(1, 3, 0.0);
  const auto found = calibrate_touch(rig.points);
  ASSERT_TRUE(found) << found.error().to_string();
  EXPECT_LT(translation_distance(found->T_base_world, rig.T_base_world), 1e-9);
  EXPECT_LT(rotation_distance(found->T_base_world, rig.T_base_world), 1e-7);
}

TEST(CalibrateTouch, StatesStdsThatHoldOn200RandomRigs) {
  std::vector<double> ratios;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    // With fewer points the errors have the long tails of Student's distribution.
    const TouchRig rig(seed, 6 + static_cast<int>(seed % 6), 1e-3);
    const auto found = calibrate_touch(rig.points);
    if (!found) continue;  // on a line, by chance
    const Vector6d error = (found->T_base_world.inverse() * rig.T_base_world).log();
    for (Eigen::Index axis = 0; axis < 6; ++axis) {
      ratios.push_back(error[axis] / std::sqrt(found->covariance(axis, axis)));
    }
  }
  EXPECT_GT(ratios.size(), 1100U);
  expect_stds_cover(ratios, 8.0);
}

TEST(CalibrateTouch, SaysWhatPointsOnALineDoNotShow) {
  TouchRig rig(2, 5, 1e-3);
  for (TouchedPoint& point : rig.points) {
    point.p_world = {point.p_world.x(), 0.2, 0.0};
    point.p_base = rig.T_base_world * point.p_world;
  }
  const auto found = calibrate_touch(rig.points);
  ASSERT_FALSE(found);
  EXPECT_NE(found.error().message.find("not observable"), std::string::npos);
}

TEST(CalibrateTouch, NamesAMirroredWorldAndAnotherScale) {
  TouchRig rig(3, 6, 2e-4);
  for (TouchedPoint& point : rig.points) point.p_world.y() = -point.p_world.y();
  const auto mirrored = calibrate_touch(rig.points);
  ASSERT_FALSE(mirrored);
  EXPECT_NE(mirrored.error().message.find("mirrored"), std::string::npos);
  TouchRig scaled(4, 6, 2e-4);
  for (TouchedPoint& point : scaled.points) point.p_world *= 1.02;
  const auto found = calibrate_touch(scaled.points);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->scale, 1.0 / 1.02, 5.0 * found->scale_std);
  ASSERT_FALSE(found->notes.empty());
}

}  // namespace
}  // namespace pcavr
