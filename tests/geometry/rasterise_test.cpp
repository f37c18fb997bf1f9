// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/geometry/rasterise.hpp"

#include <array>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/geometry/image.hpp"

namespace pcavr {
namespace {

constexpr int kWidth = 40;
constexpr int kHeight = 30;
constexpr RasterWindow kWhole{0, 0, kWidth, kHeight};

Image<int> counted(const std::vector<std::array<Eigen::Vector2f, 3>>& triangles) {
  Image<int> count(kWidth, kHeight, 0);
  for (const auto& [a, b, c] : triangles) {
    rasterise_triangle(a, b, c, kWhole, [&](int x, int y, float, float, float) { ++count(x, y); });
  }
  return count;
}

TEST(RasteriseTriangle, GivesThePixelsInsideWithTheirBarycentricCoordinates) {
  const Eigen::Vector2f a(3.0F, 2.0F), b(13.0F, 2.0F), c(3.0F, 12.0F);
  int pixels = 0;
  for (const bool is_reversed : {false, true}) {
    rasterise_triangle(a, is_reversed ? c : b, is_reversed ? b : c, kWhole,
                       [&](int x, int y, float of_a, float second, float third) {
                         const float of_b = is_reversed ? third : second;
                         const float of_c = is_reversed ? second : third;
                         EXPECT_NEAR(of_a + of_b + of_c, 1.0F, 1e-6F);
                         const Eigen::Vector2f at = of_a * a + of_b * b + of_c * c;
                         EXPECT_NEAR(at.x(), static_cast<float>(x), 1e-5F);
                         EXPECT_NEAR(at.y(), static_cast<float>(y), 1e-5F);
                         ++pixels;
                       });
  }
  EXPECT_EQ(pixels, 2 * 66);  // 11 + 10 + ... + 1, edges included
}

TEST(RasteriseTriangle, LeavesNoPixelOutBetweenTrianglesThatShareAnEdge) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> x(-5.0F, kWidth + 5.0F), y(-5.0F, kHeight + 5.0F);
  for (int trial = 0; trial < 200; ++trial) {
    // A fan about a point, which covers the whole image.
    const Eigen::Vector2f centre(x(random), y(random));
    const std::array<Eigen::Vector2f, 4> corners = {
        Eigen::Vector2f(-200.3F, -101.7F), Eigen::Vector2f(300.1F, -90.4F),
        Eigen::Vector2f(280.9F, 190.2F), Eigen::Vector2f(-150.6F, 170.8F)};
    std::vector<std::array<Eigen::Vector2f, 3>> fan;
    for (std::size_t i = 0; i < corners.size(); ++i)
      fan.push_back({centre, corners[i], corners[(i + 1) % corners.size()]});
    const Image<int> count = counted(fan);
    for (const int pixel : count.pixels()) ASSERT_GE(pixel, 1) << "trial " << trial;
  }
}

TEST(RasteriseTriangle, StaysInsideTheWindow) {
  const float huge = 1e30F;
  rasterise_triangle({-huge, -huge}, {huge, -huge}, {0.0F, huge}, {5, 6, 9, 8},
                     [](int x, int y, float, float, float) {
                       EXPECT_TRUE(x >= 5 && x < 9 && y >= 6 && y < 8) << x << ", " << y;
                     });
  rasterise_triangle({50.0F, 3.0F}, {60.0F, 3.0F}, {50.0F, 9.0F}, kWhole,
                     [](int, int, float, float, float) { FAIL(); });
}

TEST(RasteriseTriangle, ATriangleWithoutAreaHasNoPixels) {
  const Eigen::Vector2f a(3.0F, 2.0F), b(13.0F, 2.0F), c(23.0F, 2.0F);
  const Image<int> count = counted({{a, b, c}, {a, a, a}});
  for (const int pixel : count.pixels()) EXPECT_EQ(pixel, 0);
}

}  // namespace
}  // namespace pcavr
