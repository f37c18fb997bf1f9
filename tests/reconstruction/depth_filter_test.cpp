// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/reconstruction/depth_filter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

#include "reconstruction/depth_scenes.hpp"

namespace pcavr {
namespace {

const CameraModel kCamera = test::small_camera();
const DepthNoise kNoise;

TEST(FilterDepth, KeepsASlantedWall) {
  // The wall is at 45 deg; only border pixels of an exact plane are rejected.
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

/// A wall with noise at a random slant of up to 30 deg.
DepthImage random_wall(Random& random, const CameraModel& camera) {
  const double tilt = random.uniform(0.0, 30.0) * std::numbers::pi / 180.0;
  const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
  const Eigen::Vector3d normal(std::sin(tilt) * std::cos(angle), std::sin(tilt) * std::sin(angle),
                               std::cos(tilt));
  DepthImage depth = test::depth_of(test::plane(normal, random.uniform(0.8, 1.5)), camera, Pose());
  for (float& z : depth.pixels()) {
    z += static_cast<float>(kNoise.depth_std(z) * random.normal());
  }
  return depth;
}

TEST(FilterDepth, KeepsANoisyWall) {
  // Two neighbours' depths differ by noise with 1.41 std; beyond 3 times that: p = 0.0027. A pixel
  // is removed if two of its eight neighbours differ by more: by Markov's inequality at most
  // 8 p / 2 = 1.1 % of the pixels. The slant is covered by the allowance for incidence; with a long
  // focal length it is small, so that the allowance for noise counts.
  CameraModel camera = kCamera;
  camera.fx = camera.fy = 1300.0;
  Random random(61);
  for (int trial = 0; trial < 10; ++trial) {
    const DepthImage depth = random_wall(random, camera);
    const DepthImage filtered = filter_depth(depth, camera, kNoise, {1});
    int removed = 0;
    for (int v = 1; v + 1 < depth.height(); ++v) {
      for (int u = 1; u + 1 < depth.width(); ++u) removed += filtered(u, v) == 0.0F ? 1 : 0;
    }
    EXPECT_LE(removed, 0.011 * 158 * 118);
  }
}

TEST(FilterDepth, RemovesFlyingPixelsAtEdgesOfAnyDirection) {
  // The pixels that the edge between a near half plane at 1 m and a far one at 1.5 m crosses mix
  // both. The maximum difference on one surface is 3 * 1.41 * std + z / f * tan(80 deg), below 74
  // mm at 1.5 m: mixed depths from 1.075 to 1.425 m lie on neither surface. A line of them is one
  // or two pixels wide, so that each has both surfaces next to it.
  Random random(62);
  int flying = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
    const Eigen::Vector2d across(std::cos(angle), std::sin(angle));
    const double at = across.dot(Eigen::Vector2d(random.uniform(40, 120), random.uniform(30, 90)));
    DepthImage depth(kCamera.width, kCamera.height);
    for (int v = 0; v < depth.height(); ++v) {
      for (int u = 0; u < depth.width(); ++u) {
        const double share = std::clamp(across.dot(Eigen::Vector2d(u, v)) - at + 0.5, 0.0, 1.0);
        depth(u, v) = static_cast<float>(1.0 + 0.5 * share);
      }
    }
    const DepthImage filtered = filter_depth(depth, kCamera, kNoise, {1});
    for (int v = 1; v + 1 < depth.height(); ++v) {
      for (int u = 1; u + 1 < depth.width(); ++u) {
        const double distance = std::abs(across.dot(Eigen::Vector2d(u, v)) - at);
        const bool is_flying = depth(u, v) > 1.075F && depth(u, v) < 1.425F;
        flying += is_flying ? 1 : 0;
        if (is_flying) {
          ASSERT_EQ(filtered(u, v), 0.0F) << u << ' ' << v << " trial " << trial;
        }
        // Beyond the eight neighbours and half a pixel of mixing, nothing is removed.
        if (distance > std::sqrt(2.0) + 0.5) {
          ASSERT_EQ(filtered(u, v), depth(u, v));
        }
      }
    }
  }
  EXPECT_GT(flying, 5000);
}

TEST(FilterDepth, KeepsOrRemovesEachPixelAlikeInAMirroredImage) {
  // The image has random depth with steps and holes, in widths with and without a part of a SIMD
  // vector.
  Random random(63);
  for (int trial = 0; trial < 100; ++trial) {
    const int width = 1 + static_cast<int>(random.below(50));
    const int height = 1 + static_cast<int>(random.below(20));
    DepthImage depth(width, height);
    for (float& z : depth.pixels()) {
      z = static_cast<float>(1.0 + 0.5 * static_cast<double>(random.below(2)) +
                             random.uniform(0.0, 0.03));
      if (random.below(10) == 0) z = 0.0F;
    }
    DepthImage mirrored(width, height);
    for (int v = 0; v < height; ++v) {
      for (int u = 0; u < width; ++u) mirrored(width - 1 - u, height - 1 - v) = depth(u, v);
    }
    const DepthImage filtered = filter_depth(depth, kCamera, kNoise, {1});
    const DepthImage filtered_mirrored = filter_depth(mirrored, kCamera, kNoise, {2});
    for (int v = 0; v < height; ++v) {
      for (int u = 0; u < width; ++u) {
        ASSERT_EQ(filtered(u, v), filtered_mirrored(width - 1 - u, height - 1 - v));
        ASSERT_TRUE(filtered(u, v) == 0.0F || filtered(u, v) == depth(u, v));
      }
    }
  }
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
