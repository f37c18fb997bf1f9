// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot_identification/presliding.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/robots/robot_identification/replay_motion.hpp"
#include "pcavr/robots/robot_identification/robot_fit.hpp"

#include "robot_identification/simulated_arm.hpp"

namespace pcavr {
namespace {

TEST(PreslidingSign, DependsOnTheWayAndNotOnItsSteps) {
  Random random(7);
  for (int trial = 0; trial < 100; ++trial) {
    const double displacement = random.uniform(1e-4, 1e-2);
    const double start = random.uniform(-1.0, 1.0), way = random.uniform(-0.03, 0.03);
    PreslidingSign at_once(displacement, start), in_steps(displacement, start);
    at_once.move(way);
    for (int k = 0; k < 17; ++k) in_steps.move(way / 17.0);
    EXPECT_NEAR(at_once.value(), in_steps.value(), 1e-12);
    EXPECT_LE(std::abs(at_once.value()), 1.0);
  }
}

TEST(PreslidingSign, GoesFromOneSignToTheOtherOverItsDisplacement) {
  PreslidingSign sign(0.002, -1.0);
  EXPECT_NEAR(sign.slope(1.0), 1000.0, 1e-9);
  EXPECT_NEAR(sign.move(0.002), 1.0 - 2.0 * std::exp(-1.0), 1e-12);
  EXPECT_NEAR(sign.move(0.02), 1.0, 1e-3);
  EXPECT_NEAR(sign.slope(1.0), 0.0, 1.0);
}

/// Coulomb friction of the joint builds up over `displacement` [rad].
JointLog with_presliding(JointLog log, Eigen::Index joint, double displacement) {
  constexpr double kSharp = 1e-4;  // [rad] beyond the noise of the positions
  const Eigen::VectorXd position = filter_zero_phase(log.position.col(joint), 200.0, 10.0);
  log.torque.col(joint) +=
      plant_friction(joint).coulomb *
      (presliding_sign(position, displacement) - presliding_sign(position, kSharp));
  return log;
}

TEST(FitRobot, FindsFrictionThatBuildsUpByDisplacement) {
  constexpr Eigen::Index kJoint = 4;
  constexpr double kDisplacement = 0.016;  // [rad]
  const RobotModel model = pa10();
  const JointLog log = with_presliding(simulated_log(model), kJoint, kDisplacement);
  const JointSignals signals = joint_signals(log, {});
  RobotFitOptions by_speed;
  by_speed.smoothing_speed = 0.05;
  const JointFit plain = fit_robot(signals, model, by_speed).joints[kJoint];
  const JointFit found = fit_robot(signals, model, {}).joints[kJoint];
  EXPECT_EQ(plain.sign.presliding_displacement, 0.0);
  EXPECT_NEAR(found.sign.presliding_displacement, kDisplacement, 0.5 * kDisplacement);
  EXPECT_LT(found.held_out.relative, 0.7 * plain.held_out.relative);
  EXPECT_NEAR(found.value_of(FrictionTerm::coulomb), plant_friction(kJoint).coulomb,
              0.05 * plant_friction(kJoint).coulomb);
}

// Its motor inertia acts at reversals, as a sign that changes late or early would.
TEST(FitRobot, FindsFrictionThatBuildsUpByDisplacementBesideMotorInertia) {
  constexpr Eigen::Index kJoint = 4;
  constexpr double kDisplacement = 0.004;  // [rad]
  constexpr double kMotorInertia = 3.0;    // [kg m^2]
  const RobotModel model = pa10();
  JointLog log = with_presliding(simulated_log(model), kJoint, kDisplacement);
  const Eigen::VectorXd position = filter_zero_phase(log.position.col(kJoint), 200.0, 10.0);
  log.torque.col(kJoint) +=
      kMotorInertia * differentiate(differentiate(position, 1.0 / 200.0), 1.0 / 200.0);
  const JointFit found = fit_robot(joint_signals(log, {}), model, {}).joints[kJoint];
  EXPECT_NEAR(found.sign.presliding_displacement, kDisplacement, 0.5 * kDisplacement);
  EXPECT_NEAR(found.value_of(FrictionTerm::motor_inertia), kMotorInertia, 0.1 * kMotorInertia);
}

TEST(ReplayMotion, KeepsTheStateOfFrictionThatBuildsUpByDisplacement) {
  constexpr Eigen::Index kJoint = 6;
  const RobotModel model = pa10();
  const JointLog log = with_presliding(simulated_log(model, {.rate = 500.0}), kJoint, 0.016);
  const JointSignals signals = joint_signals(log, {});
  const RobotFit fit = fit_robot(signals, model, {});
  ASSERT_GT(fit.joints[kJoint].sign.presliding_displacement, 0.0);
  RobotFit by_speed = fit;
  for (JointFit& joint : by_speed.joints) joint.sign.presliding_displacement = 0.0;
  const auto error = [&](const RobotFit& with) {
    return replay_motion(log, signals, with, model, fit.train_rows, 1.2).simulated.rms[kJoint];
  };
  EXPECT_LT(error(fit), 0.7 * error(by_speed));
}

}  // namespace
}  // namespace pcavr
