// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot/inverse_kinematics.hpp"

#include <algorithm>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/robots/robot/robot_dynamics.hpp"
#include "pcavr/robots/robot/urdf.hpp"

#include "support/source_folder.hpp"

namespace pcavr {
namespace {

RobotModel calibrated_arm(const std::string& name) {
  return read_urdf(source_folder() / "calib/robots" / name / (name + ".urdf")).value();
}

Eigen::VectorXd random_position(const RobotModel& model, Random& random, double margin = 0.0) {
  Eigen::VectorXd q(static_cast<Eigen::Index>(model.dof));
  for (std::size_t i = 0; i < model.dof; ++i) {
    const JointLimits& limits = model.joints[i].limits;
    q[static_cast<Eigen::Index>(i)] =
        random.uniform(*limits.lower + margin, *limits.upper - margin);
  }
  return q;
}

bool is_within_limits(const RobotModel& model, const Eigen::VectorXd& q) {
  for (std::size_t i = 0; i < model.dof; ++i) {
    const JointLimits& limits = model.joints[i].limits;
    const double x = q[static_cast<Eigen::Index>(i)];
    if (x < *limits.lower || x > *limits.upper) return false;
  }
  return true;
}

/// An arm with its forward kinematics and a tip.
struct Arm {
  explicit Arm(const std::string& name)
      : model(calibrated_arm(name)), dynamics(model), tool(model.link_index("tool").value()) {}
  Pose tip(const Eigen::VectorXd& q) {
    dynamics.forward_kinematics(q);
    return dynamics.T_base_link(tool);
  }
  RobotModel model;
  RobotDynamics dynamics;
  std::size_t tool;
};

class InverseKinematicsOfArms : public testing::TestWithParam<std::string> {};

TEST_P(InverseKinematicsOfArms, FindReachableTargetsWithinTheLimits) {
  Arm arm(GetParam());
  InverseKinematics solver(arm.model, arm.tool);
  const InverseKinematicsOptions options;
  Random random(11);
  constexpr int kTargets = 500;
  int reached = 0;
  int restarts = 0;
  int iterations = 0;
  for (int i = 0; i < kTargets; ++i) {
    const Pose target = arm.tip(random_position(arm.model, random));
    Eigen::VectorXd q = random_position(arm.model, random);
    const IkResult result = solver.solve(target, q);
    ASSERT_TRUE(is_within_limits(arm.model, q)) << i;
    iterations += result.iterations;
    restarts += result.restarts;
    if (result.status != IkStatus::kReached) continue;
    ++reached;
    // The forward kinematics confirm what the result claims.
    EXPECT_LE(translation_distance(arm.tip(q), target), options.position_tolerance * 1.0001);
    EXPECT_LE(rotation_distance(arm.tip(q), target), options.rotation_tolerance * 1.0001);
  }
  RecordProperty("reached", reached);
  RecordProperty("restarts", restarts);
  RecordProperty("iterations", iterations);
  EXPECT_GE(reached, kTargets * 99 / 100);
}

TEST_P(InverseKinematicsOfArms, GoAsFarAsTheyCanTowardsUnreachableTargets) {
  Arm arm(GetParam());
  InverseKinematicsOptions options;
  options.max_restarts = 3;
  InverseKinematics solver(arm.model, arm.tool, options);
  Random random(12);
  for (int i = 0; i < 50; ++i) {
    // Straight away from the shoulder, which has a stretched arm pointing there at its nearest.
    const Eigen::Vector3d direction =
        Eigen::Vector3d(random.normal(), random.normal(), std::abs(random.normal())).normalized();
    const Pose target = Pose::from_translation(3.0 * direction);
    Eigen::VectorXd q = random_position(arm.model, random, 0.3);
    const double before = translation_distance(arm.tip(q), target);
    const IkResult result = solver.solve(target, q);
    EXPECT_EQ(result.status, IkStatus::kNotReached);
    ASSERT_TRUE(q.allFinite() && is_within_limits(arm.model, q));
    EXPECT_LT(result.position_error, before);
    EXPECT_NEAR(result.position_error, translation_distance(arm.tip(q), target), 1e-9);
  }
}

TEST_P(InverseKinematicsOfArms, FollowAMovingTargetWithoutJumps) {
  Arm arm(GetParam());
  InverseKinematics solver(arm.model, arm.tool);
  Eigen::VectorXd q = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(arm.model.dof));
  q[1] = 0.5;
  q[arm.model.dof == 7 ? 3 : 2] = arm.model.dof == 7 ? 1.2 : 0.3;
  q[arm.model.dof == 7 ? 5 : 4] = 0.9;
  const Pose start = arm.tip(q);
  const double dt = 0.001;
  double max_error = 0.0;
  for (int i = 0; i < 4000; ++i) {
    const double t = i * dt;
    const Eigen::Vector3d offset(0.05 * std::sin(2.0 * t), 0.05 * (std::cos(2.0 * t) - 1.0), 0.0);
    const Pose target(start.rotation(), start.translation() + offset);
    const Eigen::VectorXd before = q;
    const IkResult result = solver.follow(target, dt, q);
    for (std::size_t k = 0; k < arm.model.dof; ++k) {
      const auto at = static_cast<Eigen::Index>(k);
      ASSERT_LE(std::abs(q[at] - before[at]),
                *arm.model.joints[k].limits.velocity * dt * (1.0 + 1e-9));
    }
    max_error = std::max(max_error, result.position_error);
  }
  // A target of 0.1 m/s is at most 0.1 mm ahead; the cycle removes most of it.
  EXPECT_LT(max_error, 1e-5);
}

// The path goes through the stretched arm and back: joints stay slow, and the tip returns.
TEST_P(InverseKinematicsOfArms, PassSingularitiesWithinTheVelocityLimits) {
  Arm arm(GetParam());
  InverseKinematics solver(arm.model, arm.tool);
  Eigen::VectorXd q = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(arm.model.dof));
  q[1] = 0.4;
  q[arm.model.dof == 7 ? 3 : 2] = 0.8;
  q[arm.model.dof == 7 ? 5 : 4] = 0.6;
  const Pose start = arm.tip(q);
  const Eigen::Vector3d outwards = start.translation().normalized();
  bool was_singular = false;
  IkResult result;
  for (int i = 0; i < 6000; ++i) {
    const double reach = 0.6 * std::sin(std::numbers::pi * std::min(1.0, i / 5000.0));
    const Pose target(start.rotation(), start.translation() + reach * outwards);
    const Eigen::VectorXd before = q;
    result = solver.follow(target, 0.001, q);
    was_singular |= result.is_singular;
    for (std::size_t k = 0; k < arm.model.dof; ++k) {
      const auto at = static_cast<Eigen::Index>(k);
      ASSERT_LE(std::abs(q[at] - before[at]),
                *arm.model.joints[k].limits.velocity * 0.001 * (1.0 + 1e-9));
    }
  }
  EXPECT_TRUE(was_singular);
  EXPECT_LT(result.position_error, 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Arms, InverseKinematicsOfArms, testing::Values("pa10", "irb120_like"),
                         [](const auto& arm) { return arm.param; });

// The seventh joint: the pose is the same, the joints are nearer to the middle of their ranges.
TEST(InverseKinematics, RedundantJointsGoToTheMiddleOfTheirRanges) {
  Arm arm("pa10");
  InverseKinematicsOptions without;
  without.centring_gain = 0.0;
  InverseKinematics plain(arm.model, arm.tool, without);
  InverseKinematics centred(arm.model, arm.tool);
  Random random(13);
  int nearer = 0;
  int compared = 0;
  for (int i = 0; i < 100; ++i) {
    const Eigen::VectorXd start = random_position(arm.model, random, 0.3);
    const Pose target = arm.tip(start);
    Eigen::VectorXd q = start;
    const IkResult result = centred.solve(target, q);
    ASSERT_EQ(result.status, IkStatus::kReached);
    if (result.restarts > 0) continue;
    ++compared;
    Eigen::VectorXd q_plain = start;
    ASSERT_EQ(plain.solve(target, q_plain).status, IkStatus::kReached);
    EXPECT_EQ(q_plain, start);
    EXPECT_LE(centred.distance_to_middle(q), centred.distance_to_middle(start) + 1e-6);
    nearer += centred.distance_to_middle(q) < 0.95 * centred.distance_to_middle(start) ? 1 : 0;
  }
  EXPECT_GE(compared, 95);
  EXPECT_GE(nearer, 30);
}

TEST(InverseKinematics, IsDeterministic) {
  Arm arm("pa10");
  InverseKinematics first(arm.model, arm.tool);
  InverseKinematics second(arm.model, arm.tool);
  Random random(14);
  for (int i = 0; i < 20; ++i) {
    const Pose target = arm.tip(random_position(arm.model, random));
    const Eigen::VectorXd start = random_position(arm.model, random);
    Eigen::VectorXd a = start;
    Eigen::VectorXd b = start;
    (void)first.solve(target, a);
    (void)second.solve(target, b);
    EXPECT_EQ(a, b);
  }
}

}  // namespace
}  // namespace pcavr
