// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/friction/limit_surface.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "friction/surfaces.hpp"

namespace pcavr {
namespace {

TEST(EllipsoidSurface, BearsItsMaximumForceAndMoment) {
  const LimitSurface surface = ellipsoid_surface(4.2, 0.24);
  EXPECT_NEAR(level(surface, {4.2, 0.0, 0.0}), 1.0, 1e-12);
  EXPECT_NEAR(level(surface, {0.0, -4.2, 0.0}), 1.0, 1e-12);
  EXPECT_NEAR(level(surface, {0.0, 0.0, 0.24}), 1.0, 1e-12);
  EXPECT_NEAR(level(surface, {2.1, 0.0, 0.0}), 0.5, 1e-12);
}

TEST(EllipsoidSurface, RotatesThePushedBodyByTheRatioOfMomentToForce) {
  // v = f / F^2, omega = m / M^2 up to one factor [Lynch & Mason 1996].
  const LimitSurface surface = ellipsoid_surface(4.0, 0.2);
  const Eigen::Vector3d twist = sliding_direction(surface, {0.0, 2.0, 0.05});
  EXPECT_NEAR(twist.z() / twist.y(), (0.05 / 0.04) / (2.0 / 16.0), 1e-9);
  EXPECT_EQ(twist.x(), 0.0);
}

TEST(EllipsoidSurface, DoesNotRotateABodyPushedThroughItsCentreOfFriction) {
  const Eigen::Vector2d centre(0.01, -0.02);
  const LimitSurface surface = ellipsoid_surface(4.0, 0.2, centre);
  const Eigen::Vector3d through(3.0, 1.0, centre.x() * 1.0 - centre.y() * 3.0);
  EXPECT_NEAR(sliding_direction(surface, through).z(), 0.0, 1e-12);
}

TEST(EllipsoidSurface, SlidingLoadHasItsClosedForm) {
  const LimitSurface surface = ellipsoid_surface(4.0, 0.2);
  const Eigen::Vector3d twist(0.01, -0.02, 0.3);
  const Eigen::Vector3d squares(16.0, 16.0, 0.04);
  const Eigen::Vector3d expected =
      squares.cwiseProduct(twist) / std::sqrt(twist.dot(squares.cwiseProduct(twist)));
  EXPECT_LT((sliding_load(surface, twist) - expected).norm(), 1e-10);
}

TEST(LimitSurface, NormalIsTheGradientOfItsLevel) {
  Random random(4);
  for (int trial = 0; trial < 50; ++trial) {
    const LimitSurface surface = random_surface(random);
    const Eigen::Vector3d scale = detail::scale_of(surface);
    const Eigen::Vector3d wrench = random_vector(random).cwiseProduct(scale);
    Eigen::Vector3d slope;
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d step = 1e-6 * scale[i] * Eigen::Vector3d::Unit(i);
      slope[i] = (level(surface, wrench + step) - level(surface, wrench - step)) / (2 * step[i]);
    }
    const double length = surface.length;
    EXPECT_LT(twist_angle(slope, sliding_direction(surface, wrench), length), 1e-7);
  }
}

TEST(LimitSurface, GradientIsLinearInItsCoefficients) {
  Random random(9);
  for (int trial = 0; trial < 50; ++trial) {
    const LimitSurface surface = random_surface(random);
    const Eigen::Map<const Eigen::Matrix<double, 15, 1>> c(surface.coefficients.data());
    const Eigen::Vector3d u = random_vector(random);
    const Eigen::Vector3d slope = 4.0 * detail::TernaryForm<4>::gradient(u) * c;
    const Eigen::Vector3d expected = detail::evaluate_quartic(surface.coefficients, u).gradient;
    EXPECT_LT((slope - expected).norm(), 1e-12 * (1.0 + expected.norm()));
  }
}

TEST(LimitSurface, LevelIsProportionalToTheWrench) {
  Random random(5);
  const LimitSurface surface = random_surface(random);
  const Eigen::Vector3d wrench = random_vector(random);
  EXPECT_NEAR(level(surface, 7.0 * wrench), 7.0 * level(surface, wrench), 1e-10);
  EXPECT_NEAR(level(surface, -wrench), level(surface, wrench), 1e-14);
}

TEST(LimitSurface, LoadAndDirectionAreInverse) {
  Random random(6);
  for (int trial = 0; trial < 200; ++trial) {
    const LimitSurface surface = random_surface(random);
    const Eigen::Vector3d wrench = random_vector(random).cwiseProduct(detail::scale_of(surface));
    const Eigen::Vector3d on_surface = wrench / level(surface, wrench);
    const Eigen::Vector3d back = sliding_load(surface, sliding_direction(surface, wrench));
    // Newton ends at 1e-13 in the slope; where the surface is flat the wrench is less accurate.
    EXPECT_LT((back - on_surface).cwiseQuotient(detail::scale_of(surface)).norm(), 1e-7) << trial;
  }
}

TEST(LimitSurface, SlidingLoadHasMaximumDissipation) {
  Random random(7);
  for (int trial = 0; trial < 200; ++trial) {
    const LimitSurface surface = random_surface(random);
    const Eigen::Vector3d twist = random_vector(random);
    const double max_power = sliding_load(surface, twist).dot(twist);
    EXPECT_GT(max_power, 0.0);
    const Eigen::Vector3d other = random_vector(random);
    EXPECT_LE((other / level(surface, other)).dot(twist), max_power * (1.0 + 1e-9));
  }
}

TEST(LimitSurface, IsZeroForZeroInput) {
  const LimitSurface surface = ellipsoid_surface(4.0, 0.2);
  const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
  EXPECT_EQ(level(surface, zero), 0.0);
  EXPECT_TRUE(sliding_direction(surface, zero).isZero(0.0));
  EXPECT_TRUE(sliding_load(surface, zero).isZero(0.0));
}

TEST(TwistAngle, WeightsRotationByTheLength) {
  EXPECT_NEAR(twist_angle({1, 0, 0}, {1, 0, 10}, 0.1), std::numbers::pi / 4, 1e-12);
  EXPECT_NEAR(twist_angle({1, 0, 0}, {-2, 0, 0}, 0.1), std::numbers::pi, 1e-12);
}

}  // namespace
}  // namespace pcavr
