// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/friction/patch.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

using Points = std::vector<Eigen::Vector2d>;

TEST(MeanRadius, OfADiscIsTwoThirdsOfItsRadius) {
  Points corners;
  for (int i = 0; i < 2000; ++i) {
    const double angle = std::numbers::pi * i / 1000.0;
    corners.emplace_back(0.1 * std::cos(angle), 0.1 * std::sin(angle));
  }
  // A polygon of 2000 corners is a disc up to 5e-6 of its radius.
  EXPECT_NEAR(mean_radius(corners, Eigen::Vector2d::Zero()), 0.2 / 3.0, 1e-6);
}

TEST(MeanRadius, OfASquareHasItsClosedForm) {
  const double expected = 0.15 / 6.0 * (std::numbers::sqrt2 + std::asinh(1.0));
  EXPECT_NEAR(mean_radius_of_rectangle(0.15, 0.15), expected, 1e-15);
}

TEST(MeanRadius, OfALongThinRectangleIsAQuarterOfItsLength) {
  EXPECT_NEAR(mean_radius_of_rectangle(1.0, 1e-6), 0.25, 1e-6);
}

TEST(MeanRadius, AgreesWithASumOverCellsAlsoAboutAPointOutside) {
  const Points triangle{{0.0, 0.0}, {0.15, 0.0}, {0.0, 0.15}};
  for (const Eigen::Vector2d& centre : {Eigen::Vector2d(0.05, 0.05), Eigen::Vector2d(-0.1, 0.3)}) {
    double sum = 0.0;
    int cells = 0;
    const int n = 1500;
    for (int i = 0; i < n; ++i) {
      for (int j = 0; i + j + 1 < n; ++j) {
        sum += (Eigen::Vector2d(i + 0.5, j + 0.5) * 0.15 / n - centre).norm();
        ++cells;
      }
    }
    EXPECT_NEAR(mean_radius(triangle, centre), sum / cells, 1e-4);  // half the cells at the slope
  }
}

TEST(MeanRadius, DoesNotDependOnTheOrderOfTheCorners) {
  const Points one{{0.0, 0.0}, {0.2, 0.0}, {0.2, 0.1}};
  const Points other{{0.2, 0.1}, {0.2, 0.0}, {0.0, 0.0}};
  EXPECT_NEAR(mean_radius(one, {0.1, 0.05}), mean_radius(other, {0.1, 0.05}), 1e-15);
}

TEST(MeanRadius, OfNothingIsZero) {
  EXPECT_EQ(mean_radius(Points{}, Eigen::Vector2d::Zero()), 0.0);
  EXPECT_EQ(mean_radius(Points{{1.0, 1.0}}, Eigen::Vector2d::Zero()), 0.0);
}

TEST(SupportShares, AreThoseOfStatics) {
  const std::array<Eigen::Vector2d, 3> points{
      Eigen::Vector2d(0.01, 0.01), Eigen::Vector2d(0.13, 0.01), Eigen::Vector2d(0.01, 0.13)};
  const auto shares = support_shares(points, {0.05, 0.05}).value();
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < 3; ++i) centre += shares[i] * points[i];
  EXPECT_NEAR((centre - Eigen::Vector2d(0.05, 0.05)).norm(), 0.0, 1e-15);
  // A real block: 78.5 mm, computed by hand.
  EXPECT_NEAR(mean_radius(points, shares, {0.05, 0.05}), 0.0785, 1e-4);
}

TEST(SupportShares, AreUnknownWhereTheBodyWouldTip) {
  const std::array<Eigen::Vector2d, 3> points{Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(0.1, 0.0),
                                              Eigen::Vector2d(0.0, 0.1)};
  EXPECT_FALSE(support_shares(points, {0.09, 0.09}).has_value());
  const std::array<Eigen::Vector2d, 3> line{Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(0.1, 0.0),
                                            Eigen::Vector2d(0.2, 0.0)};
  EXPECT_FALSE(support_shares(line, {0.1, 0.0}).has_value());
}

}  // namespace
}  // namespace pcavr
