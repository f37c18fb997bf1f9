// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/geometry/convex_hull.hpp"

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

namespace pcavr {
namespace {

TEST(ConvexHullXy, KeepsTheCornersOfASquareCounterClockwise) {
  const std::vector<Eigen::Vector3d> hull =
      convex_hull_xy({{1, 1, 5}, {0, 0, 1}, {0.5, 0.5, 9}, {1, 0, 2}, {0.5, 0, 7}, {0, 1, 3}});
  ASSERT_EQ(hull.size(), 4U);  // without the interior point and the point on an edge
  for (std::size_t i = 0; i < hull.size(); ++i) {
    EXPECT_GT(orientation_xy(hull[i], hull[(i + 1) % 4], hull[(i + 2) % 4]), 0.0);
  }
  EXPECT_EQ(hull.front(), Eigen::Vector3d(0, 0, 1));
}

TEST(ConvexHullXy, ContainsEveryPoint) {
  Random random(3);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 500; ++i) points.emplace_back(random.normal(), random.normal(), i);
  const std::vector<Eigen::Vector3d> hull = convex_hull_xy(points);
  for (const Eigen::Vector3d& p : points) {
    for (std::size_t i = 0; i < hull.size(); ++i) {
      EXPECT_GE(orientation_xy(hull[i], hull[(i + 1) % hull.size()], p), -1e-12);
    }
  }
}

TEST(ConvexHullXy, HasNoAreaForCollinearPoints) {
  EXPECT_TRUE(convex_hull_xy({}).empty());
  EXPECT_LT(convex_hull_xy({{1, 2, 3}}).size(), 3U);
  EXPECT_LT(convex_hull_xy({{0, 0, 0}, {1, 1, 0}, {2, 2, 0}}).size(), 3U);
}

}  // namespace
}  // namespace pcavr
