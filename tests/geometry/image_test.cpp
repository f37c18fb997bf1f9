// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/geometry/image.hpp"

#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/geometry/depth_noise.hpp"

namespace pcavr {
namespace {

TEST(Image, StoresRowsContiguously) {
  GrayImage image(3, 2, 9);
  image(2, 1) = 5;
  EXPECT_EQ(image.pixels()[5], 5);
  EXPECT_EQ(image.row(1)[2], 5);
  EXPECT_EQ(image.row(0).size(), 3u);
  EXPECT_EQ(image(0, 0), 9);
}

TEST(Image, ContainsChecksTheBounds) {
  const GrayImage image(3, 2);
  EXPECT_TRUE(image.contains(2, 1));
  EXPECT_FALSE(image.contains(3, 0));
  EXPECT_FALSE(image.contains(0, -1));
  EXPECT_TRUE(GrayImage().empty());
  EXPECT_THROW(GrayImage(-1, 2), ContractError);
}

TEST(ToGray, UsesBt601Weights) {
  ColorImage color(5, 1);
  color(0, 0) = {255, 255, 255};
  color(1, 0) = {255, 0, 0};
  color(2, 0) = {0, 255, 0};
  color(3, 0) = {0, 0, 255};
  const GrayImage gray = to_gray(color);
  const std::vector<int> expected{255, 76, 150, 29, 0};  // 255 times 1, 0.299, 0.587, 0.114, 0
  for (int x = 0; x < 5; ++x) EXPECT_EQ(gray(x, 0), expected[static_cast<std::size_t>(x)]);
}

TEST(DepthNoise, MatchesThePaperAtNormalIncidence) {
  const DepthNoise noise;
  EXPECT_DOUBLE_EQ(noise.depth_std(0.4), 0.0012);
  EXPECT_DOUBLE_EQ(noise.depth_std(2.4), 0.0012 + 0.0019 * 4.0);
  EXPECT_DOUBLE_EQ(noise.depth_std(2.4, 0.0), noise.depth_std(2.4));
}

TEST(DepthNoise, GrowsWithIncidenceAndStaysFinite) {
  const DepthNoise noise;
  double last = 0.0;
  for (const double degrees : {0.0, 30.0, 60.0, 80.0, 88.0}) {
    const double depth_std = noise.depth_std(1.0, degrees * std::numbers::pi / 180.0);
    EXPECT_GT(depth_std, last);
    last = depth_std;
  }
  EXPECT_LT(noise.depth_std(1.0, 0.5 * std::numbers::pi), 1.0);
}

}  // namespace
}  // namespace pcavr
