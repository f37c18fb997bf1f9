// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/marker/tag_pair.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "marker/tag_rendering.hpp"

namespace pcavr {
namespace {

using test::a_camera;
using test::facing;

constexpr double kPairCornerStd = 0.1;  // [px]
constexpr double kFirstSize = 0.12;     // [m]
constexpr double kSecondSize = 0.08;

TagDetection seen(const Pose& T_camera_marker, double size, const CameraModel& camera,
                  Random& random) {
  TagDetection detection{.id = {}, .corners = {}, .corner_std = kPairCornerStd};
  const auto corners = tag_corners(size);
  for (std::size_t i = 0; i < 4; ++i) {
    detection.corners[i] = camera.project(T_camera_marker * corners[i]) +
                           kPairCornerStd * Eigen::Vector2d(random.normal(), random.normal());
  }
  return detection;
}

/// Views of two tags that lie 0.4 m apart.
std::vector<TagPairView> views_of(const Pose& T_first_second, int count, std::uint64_t seed) {
  Random random(seed);
  std::vector<TagPairView> views;
  for (int i = 0; i < count; ++i) {
    const Pose T_camera_first = facing({-0.2, 0.02, random.uniform(0.8, 1.2)},
                                       random.uniform(0.3, 0.9), random.uniform(0.0, 6.3), 0.1);
    views.push_back({seen(T_camera_first, kFirstSize, a_camera(), random),
                     seen(T_camera_first * T_first_second, kSecondSize, a_camera(), random)});
  }
  return views;
}

Pose a_pair() {
  return Pose(Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ())),
              {0.4, 0.05, 0.0});
}

TEST(SolveTagPair, FindsTheSecondTagWhereverItsPoseIsSaidToBe) {
  for (const double stated_error : {0.0, 0.003, 0.058, 1.0}) {
    const Pose T_stated = a_pair() * Pose::from_translation({0.6 * stated_error, 0, stated_error});
    const auto found =
        solve_tag_pair(views_of(a_pair(), 12, 1), kFirstSize, kSecondSize, T_stated, a_camera());
    ASSERT_TRUE(found) << stated_error;
    EXPECT_LT(translation_distance(found->T_first_second, a_pair()), 3e-3) << stated_error;
    EXPECT_LT(rotation_distance(found->T_first_second, a_pair()), 0.02) << stated_error;
    EXPECT_LT(found->reprojection_rms, 3.0 * kPairCornerStd) << stated_error;
  }
}

TEST(SolveTagPair, FindsATagWhoseQuaternionIsInAnotherOrder) {
  const Eigen::Quaterniond q = a_pair().rotation();
  const Pose T_stated(Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y()), a_pair().translation());
  const auto found =
      solve_tag_pair(views_of(a_pair(), 8, 2), kFirstSize, kSecondSize, T_stated, a_camera());
  ASSERT_TRUE(found);
  EXPECT_LT(rotation_distance(found->T_first_second, a_pair()), 0.02);
}

TEST(SolveTagPair, StatesACovarianceThatCoversItsErrors) {
  double sum = 0.0;
  constexpr int kCases = 40;
  for (int i = 0; i < kCases; ++i) {
    const auto found = solve_tag_pair(views_of(a_pair(), 8, 100 + static_cast<unsigned>(i)),
                                      kFirstSize, kSecondSize, a_pair(), a_camera());
    ASSERT_TRUE(found);
    const Vector6d error = (found->T_first_second.inverse() * a_pair()).log();
    sum += error.dot(found->covariance.ldlt().solve(error)) / (6.0 * kCases);
  }
  // The model's own std (0.03 px) and the variance factor make it conservative.
  EXPECT_GT(sum, 0.5);
  EXPECT_LT(sum, 1.3);
}

TEST(SolveTagPair, HasNoAnswerWithoutViews) {
  EXPECT_FALSE(solve_tag_pair({}, kFirstSize, kSecondSize, a_pair(), a_camera()));
}

}  // namespace
}  // namespace pcavr
