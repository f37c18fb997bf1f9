// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/reconstruction/cloud_filter.hpp"

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

namespace pcavr {
namespace {

TEST(RemoveOutliers, RemovesFarPointsAndKeepsTheAttributesOfTheOthers) {
  // 40 x 40 points 10 mm apart, and single points at least 0.5 m from all others. Their mean
  // distance to neighbours, 0.5 m or more, is 30 times that of the others; 10 of 1610 raise the
  // mean by 4 mm and the std to at most 0.1 m: with a multiplier of 2 the limit is below 0.3 m.
  Random random(1);
  PointCloud cloud;
  const auto add = [&](const Eigen::Vector3f& p) {
    const auto tag = static_cast<std::uint8_t>(cloud.points.size() % 251);
    cloud.points.push_back(p);
    cloud.normals.emplace_back(0.0F, 0.0F, static_cast<float>(cloud.points.size()));
    cloud.colors.push_back({tag, 1, 2});
  };
  std::vector<bool> is_outlier;
  for (int i = 0; i < 1600; ++i) {
    add({0.01F * static_cast<float>(i % 40), 0.01F * static_cast<float>(i / 40),
         static_cast<float>(1e-3 * random.normal())});
    is_outlier.push_back(false);
    if (i % 160 != 80) continue;
    add({0.2F, 0.2F, 1.0F + 0.6F * static_cast<float>(i) / 160.0F});
    is_outlier.push_back(true);
  }
  OutlierOptions options;
  options.neighbours = 4;
  options.std_multiplier = 2.0;
  const PointCloud filtered = remove_outliers(cloud, options);
  std::size_t next = 0;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (is_outlier[i]) continue;
    ASSERT_LT(next, filtered.points.size());
    EXPECT_EQ(filtered.points[next], cloud.points[i]);
    EXPECT_EQ(filtered.normals[next], cloud.normals[i]);
    EXPECT_EQ(filtered.colors[next], cloud.colors[i]);
    ++next;
  }
  EXPECT_EQ(filtered.points.size(), next);
  EXPECT_EQ(filtered.normals.size(), next);
  EXPECT_EQ(filtered.colors.size(), next);
}

TEST(RemoveOutliers, LeavesACloudOfTooFewPointsUnchanged) {
  PointCloud cloud;
  EXPECT_TRUE(remove_outliers(cloud).points.empty());
  for (int i = 0; i < 12; ++i) cloud.points.emplace_back(static_cast<float>(i * i * i), 0.0F, 0.0F);
  EXPECT_EQ(remove_outliers(cloud).points, cloud.points);
  EXPECT_TRUE(remove_outliers(cloud).normals.empty());
}

}  // namespace
}  // namespace pcavr
