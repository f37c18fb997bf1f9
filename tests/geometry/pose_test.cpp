// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/geometry/pose.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/random.hpp"

namespace pcavr {
namespace {

/// Thousands of rounding errors of numbers near 1.
constexpr double kTolerance = 1e-12;

Vector6d random_twist(Random& random, double max_angle) {
  Vector6d twist;
  for (int i = 0; i < 6; ++i) twist[i] = random.uniform(-1.0, 1.0);
  twist.tail<3>() *= random.uniform(0.0, max_angle) / twist.tail<3>().norm();
  return twist;
}

Pose random_pose(Random& random) { return Pose::exp(random_twist(random, 3.1)); }

double difference(const Pose& a, const Pose& b) {
  return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff();
}

TEST(Pose, QuarterTurnAboutZMapsXToY) {
  const double half = std::sqrt(0.5);
  const Pose T_a_b(Eigen::Quaterniond(half, 0, 0, half), {1, 2, 3});
  EXPECT_LT((T_a_b * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(1, 3, 3)).norm(), kTolerance);
}

TEST(Pose, SatisfiesTheGroupAxioms) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const Pose a = random_pose(random);
    const Pose b = random_pose(random);
    const Pose c = random_pose(random);
    const Eigen::Vector3d p(random.normal(), random.normal(), random.normal());
    EXPECT_LT(difference((a * b) * c, a * (b * c)), kTolerance);
    EXPECT_LT(difference(a * a.inverse(), Pose()), kTolerance);
    EXPECT_LT(((a * b) * p - a * (b * p)).norm(), kTolerance);
    EXPECT_LT((a.matrix() * b.matrix() - (a * b).matrix()).norm(), kTolerance);
  }
}

TEST(Pose, LogUndoesExp) {
  Random random(2);
  for (const double angle : {0.0, 1e-12, 1e-7, 1e-4, 1.1e-4, 1e-2, 1.0, 3.1}) {
    Vector6d twist = random_twist(random, 1.0);
    twist.tail<3>() *= angle / twist.tail<3>().norm();
    EXPECT_LT((Pose::exp(twist).log() - twist).norm(), 1e-11) << "angle " << angle;
  }
}

TEST(Pose, ExpUndoesLogAtHalfATurn) {
  const Pose half_turn(Eigen::Quaterniond(0, 0, 1, 0), {1, 2, 3});
  EXPECT_NEAR(half_turn.log().tail<3>().norm(), std::numbers::pi, kTolerance);
  EXPECT_LT(difference(Pose::exp(half_turn.log()), half_turn), 1e-11);
}

TEST(Pose, ExpOfAScrewIsAHelix) {
  Vector6d twist;
  twist << 0, 0, 0.5, 0, 0, std::numbers::pi;  // half a turn about z while rising by 0.5
  const Pose T = Pose::exp(twist);
  EXPECT_LT((T * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(-1, 0, 0.5)).norm(), kTolerance);
}

TEST(Pose, FromMatrixUndoesMatrix) {
  Random random(3);
  const Pose pose = random_pose(random);
  EXPECT_LT(difference(Pose::from_matrix(pose.matrix()), pose), kTolerance);
}

TEST(Pose, RejectsNonRigidTransforms) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(Pose(Eigen::Quaterniond(0, 0, 0, 0), {0, 0, 0}), ContractError);
  EXPECT_THROW(Pose(Eigen::Quaterniond::Identity(), {nan, 0, 0}), ContractError);
  Eigen::Matrix4d mirror = Eigen::Matrix4d::Identity();
  mirror(0, 0) = -1.0;
  EXPECT_THROW((void)Pose::from_matrix(mirror), ContractError);
  EXPECT_THROW((void)Pose::from_matrix(2.0 * Eigen::Matrix4d::Identity()), ContractError);
}

TEST(Interpolate, ReachesItsEndsAndTheMiddle) {
  Vector6d twist;
  twist << 0, 0, 0, 0, 0, 1.0;
  const Pose end(Pose::exp(twist).rotation(), {2, 0, 0});
  EXPECT_LT(difference(interpolate(Pose(), end, 0.0), Pose()), kTolerance);
  EXPECT_LT(difference(interpolate(Pose(), end, 1.0), end), kTolerance);
  const Pose middle = interpolate(Pose(), end, 0.5);
  EXPECT_NEAR(rotation_distance(Pose(), middle), 0.5, kTolerance);
  EXPECT_NEAR(translation_distance(Pose(), middle), 1.0, kTolerance);
}

TEST(Skew, IsTheCrossProduct) {
  const Eigen::Vector3d a(1, 2, 3);
  const Eigen::Vector3d b(-4, 5, 0.5);
  EXPECT_LT((skew(a) * b - a.cross(b)).norm(), kTolerance);
}

}  // namespace
}  // namespace pcavr
