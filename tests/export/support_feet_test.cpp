// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "results/export/support_feet.hpp"

#include <gtest/gtest.h>

namespace pcavr::detail {
namespace {

TEST(SupportFeet, HaveTheTurningTorqueOfTheLimitSurface) {
  for (const double radius : {0.02, 0.038, 0.06}) {
    const LimitSurface surface = ellipsoid_surface(3.0, 3.0 * radius);
    const auto feet = fit_feet(surface);
    EXPECT_NEAR(turning_radius_of(feet), radius, 1e-9);
    // An ellipsoid is the surface of no pressure: point contacts miss it at motions between
    // translation and rotation. Uniform pressure has 0.06.
    EXPECT_LT(error_of(feet, surface).rms, 0.16);
  }
}

TEST(SupportFeet, AreEquallyFastInATurn) {
  for (const PlanarFoot& foot : fit_feet(ellipsoid_surface(1.0, 0.05))) {
    EXPECT_NEAR(foot.position.norm(), 0.05, 1e-9);
  }
}

TEST(SupportFeet, HaveTheFrictionCentreOfTheLimitSurface) {
  const Eigen::Vector2d centre(0.006, -0.004);
  const LimitSurface surface = ellipsoid_surface(2.0, 0.08, centre);
  const auto feet = fit_feet(surface);
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const PlanarFoot& foot : feet) {
    mean += foot.friction * foot.position / static_cast<double>(feet.size());
  }
  EXPECT_NEAR((mean - centre).norm(), 0.0, 2e-4);
}

}  // namespace
}  // namespace pcavr::detail
