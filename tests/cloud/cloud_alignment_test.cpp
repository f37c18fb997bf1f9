// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/cloud/cloud_alignment.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

namespace pcavr {
namespace {

using Points = std::vector<Eigen::Vector3f>;

/// A table with a wall and three blocks, sampled at random with noise of 1 mm: what lies within
/// 1.2 m of `centre`, seen from a sensor at T_world_cloud.
Points view_of_room(const Pose& T_world_cloud, const Eigen::Vector3d& centre, std::uint64_t seed) {
  struct Patch {
    Eigen::Vector3d corner, a, b;
  };
  std::vector<Patch> patches = {{{-1, -1, 0}, {2, 0, 0}, {0, 2, 0}},
                                {{-1, 1, 0}, {2, 0, 0}, {0, 0, 1}}};
  for (const Eigen::Vector3d& at : {Eigen::Vector3d(-0.6, -0.2, 0), Eigen::Vector3d(0.1, 0.3, 0),
                                    Eigen::Vector3d(0.5, -0.5, 0)}) {
    const Eigen::Vector3d size(0.2 + 0.1 * at.x(), 0.15, 0.3 + 0.2 * at.y());
    patches.push_back({at + Eigen::Vector3d(0, 0, size.z()), {size.x(), 0, 0}, {0, size.y(), 0}});
    patches.push_back({at, {size.x(), 0, 0}, {0, 0, size.z()}});
    patches.push_back({at, {0, size.y(), 0}, {0, 0, size.z()}});
  }
  Random random(seed);
  Points points;
  const Pose T_cloud_world = T_world_cloud.inverse();
  for (const Patch& patch : patches) {
    const auto count = static_cast<int>(12'000 * patch.a.norm() * patch.b.norm());
    for (int i = 0; i < count; ++i) {
      Eigen::Vector3d p = patch.corner + random.uniform() * patch.a + random.uniform() * patch.b;
      if ((p - centre).norm() > 1.2) continue;
      p += 0.001 * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
      points.push_back((T_cloud_world * p).cast<float>());
    }
  }
  return thinned(points, 0.02);
}

Pose small_motion(int step) {
  Vector6d twist;
  twist << 0.02 * step, -0.015 * step, 0.01 * step, 0.01 * step, 0.02 * step, -0.03 * step;
  return Pose::exp(twist);
}

TEST(CloudAlignment, FollowsSmallMotions) {
  std::vector<Points> clouds;
  for (int i = 0; i < 4; ++i) {
    clouds.push_back(view_of_room(small_motion(i), {0, 0, 0}, static_cast<std::uint64_t>(i + 1)));
  }
  const CloudAlignment alignment = align_clouds(clouds, {.voxel = 0.02});
  ASSERT_FALSE(alignment.failed);
  for (int i = 0; i < 4; ++i) {
    const Pose& found = alignment.T_world_cloud[static_cast<std::size_t>(i)];
    EXPECT_LT(translation_distance(found, small_motion(i)), 0.003) << i;
    EXPECT_LT(rotation_distance(found, small_motion(i)), 0.004) << i;
  }
  EXPECT_EQ(alignment.by_features, 0U);
  EXPECT_GT(alignment.min_overlap, 0.7);
}

/// Half a turn about the vertical: ICP alone would stay at a wrong minimum.
TEST(CloudAlignment, FindsALargeMotionByFeatures) {
  Vector6d twist;
  twist << 0.0, 0.0, 0.0, 0.0, 0.0, 2.5;
  const Pose T_world_second = Pose::from_translation({0.4, -0.3, 0.2}) * Pose::exp(twist);
  const std::vector<Points> clouds = {view_of_room(Pose(), {0, 0, 0}, 1),
                                      view_of_room(T_world_second, {0, 0, 0}, 2)};
  const CloudAlignment alignment = align_clouds(clouds, {.voxel = 0.02, .min_overlap = 0.6});
  ASSERT_FALSE(alignment.failed);
  EXPECT_LT(translation_distance(alignment.T_world_cloud[1], T_world_second), 0.005);
  EXPECT_LT(rotation_distance(alignment.T_world_cloud[1], T_world_second), 0.005);
  EXPECT_EQ(alignment.by_features, 1U);
}

TEST(CloudAlignment, CloudsOfOtherPlacesFail) {
  Points line;
  for (int i = 0; i < 400; ++i) {
    const double a = 0.05 * i;
    line.push_back(
        Eigen::Vector3d(0.02 * i, 3.0 * std::sin(a), 2.0 * std::cos(1.7 * a)).cast<float>());
  }
  const CloudAlignment alignment =
      align_clouds({view_of_room(Pose(), {0, 0, 0}, 1), line}, {.voxel = 0.02});
  ASSERT_TRUE(alignment.failed);
  EXPECT_EQ(*alignment.failed, 1U);
}

TEST(CloudAlignment, AgreementIsTheShareOfNearPoints) {
  const Points a = {{0, 0, 1}, {1, 0, 1}, {2, 0, 1}, {3, 0, 1}};
  const Points b = {{0, 0.01F, 1}, {1, 0.01F, 1}, {2, 0.5F, 1}, {3, 0.5F, 1}};
  const CloudAgreement agreement = compare_clouds(a, b, {Pose()}, 0.05).at(0);
  EXPECT_DOUBLE_EQ(agreement.overlap, 0.5);
  EXPECT_NEAR(agreement.rms, 0.01, 1e-6);
}

}  // namespace
}  // namespace pcavr
