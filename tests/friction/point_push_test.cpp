// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/friction/point_push.hpp"

#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "friction/surfaces.hpp"

namespace pcavr {
namespace {

TEST(PointPush, ThroughTheCentreMovesTheBodyStraight) {
  const PushMotion motion =
      push_at_point(ellipsoid_surface(4.0, 0.2), {{-0.05, 0.0}, {1.0, 0.0}, 0.3, {0.02, 0.0}});
  EXPECT_EQ(motion.mode, PushMode::sticking);
  EXPECT_LT((motion.twist - Eigen::Vector3d(0.02, 0.0, 0.0)).norm(), 1e-12);
  EXPECT_LT((motion.wrench - Eigen::Vector3d(4.0, 0.0, 0.0)).norm(), 1e-9);
}

TEST(PointPush, FrictionlessAndOffCentreAgreesWithLynchAndMason) {
  // Force along the normal at y = 0.03: omega / vx = m / M^2 * F^2 / f = -y / c^2, c = M / F.
  const double c = 0.05;
  const PushMotion motion = push_at_point(ellipsoid_surface(4.0, 4.0 * c),
                                          {{-0.05, 0.03}, {1.0, 0.0}, 0.0, {0.02, 0.005}});
  EXPECT_EQ(motion.mode, PushMode::slipping);
  EXPECT_NEAR(motion.twist.z() / motion.twist.x(), -0.03 / (c * c), 1e-9);
  EXPECT_NEAR(velocity_of({-0.05, 0.03}, motion.twist).x(), 0.02, 1e-12);
}

TEST(PointPush, SticksInsideTheMotionConeAndKeepsThePoint) {
  Random random(8);
  int sticking = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const LimitSurface surface = random_surface(random);
    const PointPush push{0.05 * random_vector(random).head<2>(), random_vector(random).head<2>(),
                         random.uniform(0.0, 1.5), 0.02 * random_vector(random).head<2>()};
    const PushMotion motion = push_at_point(surface, push);
    const Eigen::Vector2d normal = push.normal.normalized();
    if (motion.mode == PushMode::separating) {
      EXPECT_LE(normal.dot(push.velocity), 0.0);
      continue;
    }
    const Eigen::Vector2d slip = velocity_of(push.point, motion.twist) - push.velocity;
    const Eigen::Vector2d force = motion.wrench.head<2>();
    const Eigen::Vector2d tangent(-normal.y(), normal.x());
    EXPECT_NEAR(level(surface, motion.wrench), 1.0, 1e-9);
    EXPECT_NEAR(normal.dot(slip), 0.0, 1e-9) << trial;
    EXPECT_LE(std::abs(tangent.dot(force)),
              push.friction_coefficient * normal.dot(force) * (1.0 + 1e-9) + 1e-12);
    EXPECT_GE(motion.wrench.dot(motion.twist), 0.0);
    if (motion.mode == PushMode::sticking) {
      EXPECT_LT(slip.norm(), 1e-9) << trial;
      ++sticking;
    } else {
      // The finger moves against the friction force that it exerts along the edge.
      EXPECT_LE(tangent.dot(force) * tangent.dot(slip), 1e-12) << trial;
    }
  }
  EXPECT_GT(sticking, 30);
}

TEST(PointPush, AwayFromTheBodyMovesNothing) {
  const PushMotion motion =
      push_at_point(ellipsoid_surface(4.0, 0.2), {{-0.05, 0.0}, {1.0, 0.0}, 0.3, {-0.02, 0.01}});
  EXPECT_EQ(motion.mode, PushMode::separating);
  EXPECT_TRUE(motion.twist.isZero(0.0));
}

TEST(PointPush, DoesNotDependOnTheAxes) {
  Random random(9);
  const double angle = 0.7;
  const Eigen::Rotation2Dd rotation(angle);
  const LimitSurface round = ellipsoid_surface(4.0, 0.2);
  const PointPush push{{-0.05, 0.02}, {1.0, 0.1}, 0.3, {0.02, 0.01}};
  const PointPush rotated{rotation * push.point, rotation * push.normal, 0.3,
                          rotation * push.velocity};
  const Eigen::Vector3d a = push_at_point(round, push).twist;
  const Eigen::Vector3d b = push_at_point(round, rotated).twist;
  EXPECT_LT((rotation * a.head<2>() - b.head<2>()).norm(), 1e-12);
  EXPECT_NEAR(a.z(), b.z(), 1e-12);
}

}  // namespace
}  // namespace pcavr
