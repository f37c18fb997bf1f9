// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/arm/driven_arm.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/robots/robot/urdf.hpp"

#include "support/source_folder.hpp"

namespace pcavr {
namespace {

constexpr double kDrivenCycle = 0.001;  // [s]

RobotModel six_axis_arm() {
  return read_urdf(source_folder() / "calib/robots/irb120_like/irb120_like.urdf").value();
}

Eigen::VectorXd bent() {
  Eigen::VectorXd q(6);
  q << 0.3, 0.4, 0.4, 0.1, 0.7, -0.2;
  return q;
}

std::vector<JointFit> friction_of(double coulomb, double viscous) {
  JointFit joint;
  joint.sign.smoothing_speed = 0.01;
  joint.friction = {{.term = FrictionTerm::coulomb, .value = coulomb},
                    {.term = FrictionTerm::viscous, .value = viscous}};
  return std::vector<JointFit>(6, joint);
}

TEST(DrivenArm, StaysWhereItIsUnderGravity) {
  DrivenArm arm(six_axis_arm(), friction_of(1.0, 1.0));
  arm.reset(bent());
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(6);
  for (int i = 0; i < 1000; ++i) arm.step(bent(), none, kDrivenCycle);
  EXPECT_LT((arm.q() - bent()).cwiseAbs().maxCoeff(), 1e-9);
}

// M rate^2 (q_command - q) is the external torque in equilibrium.
TEST(DrivenArm, GivesWayByItsControllersStiffness) {
  DrivenArmOptions options;
  options.bandwidth = 8.0;
  DrivenArm arm(six_axis_arm(), friction_of(0.0, 1.0), options);
  arm.reset(bent());
  Eigen::VectorXd external(6);
  external << 3.0, -5.0, 2.0, 0.1, 0.2, -0.05;
  for (int i = 0; i < 3000; ++i) arm.step(bent(), external, kDrivenCycle);
  Eigen::MatrixXd mass(6, 6);
  arm.dynamics().mass_matrix(arm.q(), mass);
  const double rate = 2.0 * std::numbers::pi * options.bandwidth;
  const Eigen::VectorXd balance = rate * rate * mass * (arm.q() - bent());
  EXPECT_LT((balance - external).cwiseAbs().maxCoeff(), 1e-3);
}

// A joint's inertia without friction and gravity's change is M's diagonal: the rotor's share is the
// description's where it states one, else the option's.
TEST(DrivenArm, HasTheRotorInertiasOfTheDescriptionOrTheOption) {
  RobotModel model = six_axis_arm();
  model.joints[1].armature = 0.7;
  DrivenArmOptions options;
  options.rotor_inertia_per_torque = 0.01;
  Eigen::MatrixXd bare(6, 6), with_rotors(6, 6);
  RobotModel without = model;
  without.joints[1].armature = 0.0;
  RobotDynamics(without).mass_matrix(bent(), bare);
  DrivenArm arm(model, {}, options);
  arm.dynamics().mass_matrix(bent(), with_rotors);
  const Eigen::VectorXd rotors = (with_rotors - bare).diagonal();
  EXPECT_NEAR(rotors[0], 0.01 * *model.joints[0].limits.effort, 1e-12);
  EXPECT_NEAR(rotors[1], 0.7, 1e-12);
  EXPECT_NEAR(rotors[5], 0.01 * *model.joints[5].limits.effort, 1e-12);
}

TEST(DrivenArm, NeverTurnsHarderThanItsMotorsButArrives) {
  const RobotModel model = six_axis_arm();
  DrivenArm arm(model, friction_of(1.0, 1.0));
  arm.reset(bent());
  Eigen::VectorXd target = bent();
  target[0] += 1.0;
  target[1] -= 0.6;
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(6);
  double max_ratio = 0.0;
  for (int i = 0; i < 4000; ++i) {
    arm.step(target, none, kDrivenCycle);
    max_ratio = std::max(max_ratio, arm.torque_ratio());
    for (std::size_t j = 0; j < 6; ++j) {
      ASSERT_LE(std::abs(arm.tau()[static_cast<Eigen::Index>(j)]),
                *model.joints[j].limits.effort * (1.0 + 1e-12));
    }
  }
  EXPECT_GT(max_ratio, 1.0);
  EXPECT_LT((arm.q() - target).cwiseAbs().maxCoeff(), 1e-3);
}

// The limits of the description are stops.
TEST(DrivenArm, StopsAtTheLimitsOfItsJoints) {
  DrivenArm arm(six_axis_arm(), friction_of(1.0, 1.0));
  arm.reset(bent());
  Eigen::VectorXd beyond = bent();
  beyond[2] = 3.0;
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(6);
  for (int i = 0; i < 2000; ++i) arm.step(beyond, none, kDrivenCycle);
  EXPECT_DOUBLE_EQ(arm.q()[2], 1.22);
}

TEST(DrivenArm, TakesTheDescriptionsFrictionWithoutAnIdentifiedOne) {
  RobotJoint joint;
  joint.friction = 2.0;
  joint.damping = 3.0;
  const JointFit fit = described_friction(joint);
  EXPECT_NEAR(friction_torque(fit, 0.0, 1.0, 0.0), 5.0, 1e-12);
  EXPECT_NEAR(friction_torque(fit, 0.0, -1.0, 0.0), -5.0, 1e-12);
}

TEST(DrivenArm, RejectsABodyWithoutMass) {
  RobotModel model = six_axis_arm();
  for (RobotJoint& joint : model.joints) joint.body = {};
  EXPECT_THROW(DrivenArm(model, {}), ContractError);
}

}  // namespace
}  // namespace pcavr
