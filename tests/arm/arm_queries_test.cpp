// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/arm/arm_queries.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "pcavr/base/core/gravity.hpp"
#include "pcavr/robots/robot/link_meshes.hpp"
#include "pcavr/robots/robot/urdf.hpp"

#include "support/source_folder.hpp"

namespace pcavr {
namespace {

/// The tip at about (0.44, 0, 0.38) m, pointing forward and down.
QueriedArm queried_arm() {
  RobotModel model =
      read_urdf(source_folder() / "calib/robots/irb120_like/irb120_like.urdf").value();
  Eigen::VectorXd q(6);
  q << 0.0, 0.3, 0.3, 0.0, 0.7, 0.0;
  QueriedArm arm{.model = std::move(model), .friction = {}, .tip = 0, .q = q};
  arm.tip = default_tip(arm.model);
  JointFit joint;
  joint.sign.smoothing_speed = 0.02;
  joint.friction = {{.term = FrictionTerm::coulomb, .value = 0.5},
                    {.term = FrictionTerm::viscous, .value = 0.5}};
  arm.friction.assign(6, joint);
  return arm;
}

Eigen::Vector3d tip_of(const QueriedArm& arm) {
  RobotDynamics kinematics(arm.model);
  kinematics.forward_kinematics(arm.q);
  return kinematics.T_base_link(arm.tip).translation();
}

TEST(CanReach, KnowsTheLeastTimeAndThatLessIsNotEnough) {
  const QueriedArm arm = queried_arm();
  const Eigen::Vector3d target = tip_of(arm) + Eigen::Vector3d(-0.05, 0.2, 0.05);
  const auto still = [&](double) { return target; };
  const ReachAnswer earliest = can_reach(arm, still, {});
  ASSERT_TRUE(earliest.is_possible) << earliest.reason;
  ASSERT_TRUE(earliest.min_time.has_value());
  EXPECT_GT(*earliest.min_time, 0.1);
  EXPECT_LT(*earliest.min_time, 2.0);
  EXPECT_LE(earliest.error.value(), ArmQueryOptions().position_tolerance);
  EXPECT_TRUE(can_reach(arm, still, 1.2 * *earliest.min_time).is_possible);
  const ReachAnswer sooner = can_reach(arm, still, 0.7 * *earliest.min_time);
  EXPECT_FALSE(sooner.is_possible);
  EXPECT_FALSE(sooner.reason.empty());
}

TEST(CanReach, SaysThatAPointIsOutOfReach) {
  const ReachAnswer answer =
      can_reach(queried_arm(), [](double) { return Eigen::Vector3d(2.0, 0.0, 0.3); }, {});
  EXPECT_FALSE(answer.is_possible);
  EXPECT_FALSE(answer.min_time.has_value());
  EXPECT_NE(answer.reason.find("out of reach"), std::string::npos);
}

// Paper A's example: the body passes once, and is caught while it is within reach.
TEST(CanReach, CatchesABodyThatPasses) {
  const QueriedArm arm = queried_arm();
  const Eigen::Vector3d from = tip_of(arm) + Eigen::Vector3d(0.0, 0.9, 0.0);
  const auto passing = [&](double t) -> Eigen::Vector3d {
    return from + Eigen::Vector3d(0.0, -0.8, 0.0) * t;
  };
  const ReachAnswer caught = can_reach(arm, passing, {});
  ASSERT_TRUE(caught.is_possible) << caught.reason;
  EXPECT_EQ(caught.p_target, passing(caught.time));
  EXPECT_LE(caught.error.value(), ArmQueryOptions().position_tolerance);
  // It cannot wait: 3 s later the body has left.
  EXPECT_FALSE(can_reach(arm, passing, 3.0).is_possible);
}

TEST(CanReach, RefusesAMotionThroughAnObstacle) {
  QueriedArm arm = queried_arm();
  arm.link_meshes = link_meshes(arm.model).value().of_link;
  const Eigen::Vector3d target = tip_of(arm) + Eigen::Vector3d(-0.05, 0.25, 0.0);
  const auto still = [&](double) { return target; };
  EXPECT_TRUE(can_reach(arm, still, 2.0).is_possible);
  // A wall beside the upper arm, where the elbow passes.
  TriangleMesh wall;
  wall.vertices = {
      {-0.5F, 0.12F, 0.2F}, {0.6F, 0.12F, 0.2F}, {0.6F, 0.12F, 0.8F}, {-0.5F, 0.12F, 0.8F}};
  wall.triangles = {{0, 1, 2}, {0, 2, 3}};
  arm.obstacles = {wall};
  const ReachAnswer blocked = can_reach(arm, still, 2.0);
  EXPECT_FALSE(blocked.is_possible);
  EXPECT_NE(blocked.reason.find("too close"), std::string::npos) << blocked.reason;
}

TEST(CanHold, FindsTheLargestForce) {
  const QueriedArm arm = queried_arm();
  const Eigen::Vector3d p = tip_of(arm);
  const Eigen::Vector3d down(0.0, 0.0, -1.0);
  const HoldAnswer light = can_hold(arm, p, 5.0 * down);
  ASSERT_TRUE(light.is_possible) << light.reason;
  EXPECT_GT(light.max_force, 20.0);
  EXPECT_TRUE(can_hold(arm, p, 0.97 * light.max_force * down).is_possible);
  const HoldAnswer heavy = can_hold(arm, p, 1.05 * light.max_force * down);
  EXPECT_FALSE(heavy.is_possible);
  EXPECT_FALSE(heavy.reason.empty());
}

TEST(ReleaseSpeed, IsCoulombsWithoutViscousFriction) {
  FrictionParameters body{.mass = 2.0, .coulomb_force = 0.3 * 2.0 * kStandardGravity};
  const ReleaseSpeed release = release_speed(body, 0.25);
  EXPECT_NEAR(release.speed, std::sqrt(2.0 * 0.3 * kStandardGravity * 0.25), 1e-5);
  EXPECT_NEAR(release.sliding_time, release.speed / (0.3 * kStandardGravity), 1e-4);
  body.viscous = 5.0;
  EXPECT_GT(release_speed(body, 0.25).speed, 1.1 * release.speed);
}

TEST(CanPush, DependsOnTheBodysMassAndTheDistance) {
  const QueriedArm arm = queried_arm();
  const Eigen::Vector3d p = tip_of(arm) + Eigen::Vector3d(0.0, 0.0, -0.1);
  const auto box = [](double mass) -> FrictionParameters {
    return {.mass = mass, .coulomb_force = 0.3 * mass * kStandardGravity};
  };
  const PushAnswer light = can_push(arm, box(1.0), 0.02, p, Eigen::Vector3d::UnitY());
  EXPECT_TRUE(light.is_possible) << light.reason;
  EXPECT_NEAR(light.reached_speed, light.speed, 0.1 * light.speed);
  EXPECT_NEAR(light.force, light.speed * light.speed / 0.1 + 0.3 * kStandardGravity, 0.01);
  const PushAnswer heavy = can_push(arm, box(200.0), 0.02, p, Eigen::Vector3d::UnitY());
  EXPECT_FALSE(heavy.is_possible);
  EXPECT_FALSE(heavy.reason.empty());
}

}  // namespace
}  // namespace pcavr
