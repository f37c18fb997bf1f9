// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/reconstruction/depth_filter.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "reconstruction/depth_scenes.hpp"

namespace pcavr {
namespace {

const CameraModel kCamera = test::small_camera();
const DepthNoise kNoise;

TEST(FilterDepth, KeepsASlantedWall) {
  // At 45 deg; of an exact plane only border pixels are rejected.
  const auto wall = test::plane(Eigen::Vector3d(1.0, 0.0, 1.0).normalized(), 1.0);
  const DepthImage depth = test::depth_of(wall, kCamera, Pose());
  const DepthImage filtered = filter_depth(depth, kCamera, kNoise, {1});
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 0; u < depth.width(); ++u) {
      const bool in_range = depth(u, v) <= static_cast<float>(kNoise.max_depth);
      const bool at_border = u == 0 || v == 0 || u == depth.width() - 1 || v == depth.height() - 1;
      if (in_range && !at_border) {
        EXPECT_EQ(filtered(u, v), depth(u, v)) << u << ' ' << v;
      }
    }
  }
}

TEST(FilterDepth, RemovesThePixelsOnBothSidesOfADiscontinuity) {
  DepthImage depth(40, 20, 1.0F);
  for (int v = 0; v < 20; ++v) {
    for (int u = 20; u < 40; ++u) depth(u, v) = 1.5F;
  }
  const DepthImage filtered = filter_depth(depth, kCamera, kNoise, {1});
  EXPECT_EQ(filtered(18, 10), 1.0F);
  EXPECT_EQ(filtered(19, 10), 0.0F);
  EXPECT_EQ(filtered(20, 10), 0.0F);
  EXPECT_EQ(filtered(21, 10), 1.5F);
}

TEST(FilterDepth, RemovesAnOutlierButNotItsNeighbours) {
  DepthImage depth(20, 20, 1.0F);
  depth(10, 10) = 2.0F;
  const DepthImage filtered = filter_depth(depth, kCamera, kNoise, {1});
  EXPECT_EQ(filtered(10, 10), 0.0F);
  EXPECT_EQ(filtered(9, 10), 1.0F);
  EXPECT_EQ(filtered(11, 11), 1.0F);
}

TEST(FilterDepth, RemovesInvalidDepth) {
  DepthImage depth(20, 20, 1.0F);
  depth(5, 5) = std::numeric_limits<float>::quiet_NaN();
  depth(5, 10) = std::numeric_limits<float>::infinity();
  depth(5, 15) = -1.0F;
  depth(10, 5) = 0.1F;
  const DepthImage filtered = filter_depth(depth, kCamera, kNoise, {1});
  for (const auto& [u, v] : {std::pair(5, 5), {5, 10}, {5, 15}, {10, 5}}) {
    EXPECT_EQ(filtered(u, v), 0.0F);
  }
  EXPECT_EQ(filtered(15, 15), 1.0F);
  EXPECT_TRUE(filter_depth(DepthImage(), kCamera, kNoise, {1}).empty());
}

TEST(FilterDepth, GivesTheSameBitsOnAnyNumberOfThreads) {
  const auto scene = test::nearest_of(test::sphere({0.0, 0.0, 1.0}, 0.2),
                                      test::plane(Eigen::Vector3d::UnitZ(), 1.6));
  const DepthImage depth = test::depth_of(scene, kCamera, Pose());
  const DepthImage one = filter_depth(depth, kCamera, kNoise, {1});
  for (const int threads : {2, 4}) {
    const DepthImage many = filter_depth(depth, kCamera, kNoise, {threads});
    EXPECT_TRUE(std::equal(one.pixels().begin(), one.pixels().end(), many.pixels().begin()));
  }
}

}  // namespace
}  // namespace pcavr
