// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot_identification/joint_coupling.hpp"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/recordings/recording/import_joint_log.hpp"
#include "pcavr/robots/robot_identification/log_checks.hpp"

#include "robot_identification/simulated_arm.hpp"
#include "support/shared_data.hpp"

namespace pcavr {
namespace {

TEST(FindCouplings, FindsAWristsMotorThatTurnsWithTwoJoints) {
  for (const double ratio : {1.0, -1.0, 2.0}) {
    const CoupledMotor motor{.carrier = 4, .driven = 5, .ratio = ratio};
    JointLog log = simulated_log(pa10(), {.duration = 30.0, .seed = 51});
    add_coupled_motor(motor, log);
    const auto found = find_couplings(joint_signals(log, {}), pa10(), 0.65);
    ASSERT_EQ(found.size(), 1U) << ratio;
    EXPECT_EQ(found[0].carrier, motor.carrier);
    EXPECT_EQ(found[0].driven, motor.driven);
    EXPECT_EQ(found[0].ratio, ratio);
    EXPECT_NEAR(found[0].viscous.value, motor.viscous, 0.1 * motor.viscous) << ratio;
    EXPECT_NEAR(found[0].coulomb.value, motor.coulomb, 0.1 * motor.coulomb) << ratio;
  }
}

TEST(FindCouplings, FindsNoneInAnArmWithoutThem) {
  for (const std::uint64_t seed : {51U, 52U, 53U}) {
    const JointLog log = simulated_log(pa10(), {.duration = 30.0, .seed = seed});
    EXPECT_TRUE(find_couplings(joint_signals(log, {}), pa10(), 0.65).empty()) << seed;
  }
}

TEST(RemoveCouplings, LeavesTheTorquesOfTheArmWithoutThem) {
  const JointLog sound = simulated_log(pa10(), {.duration = 30.0, .seed = 51});
  JointLog log = sound;
  add_coupled_motor({.carrier = 4, .driven = 5}, log);
  JointSignals signals = joint_signals(log, {});
  const auto found = find_couplings(signals, pa10(), 0.65);
  ASSERT_EQ(found.size(), 1U);
  const Eigen::MatrixXd before = log.torque - sound.torque;
  remove_couplings(found, signals, log);
  for (const Eigen::Index joint : {4, 5}) {
    // But for own inertia and viscous friction, which the joint's own terms take up.
    EXPECT_LT((log.torque - sound.torque).col(joint).norm(), before.col(joint).norm()) << joint;
  }
}

TEST(FindCouplings, FindsNoneInRealArmsWithoutThem) {
  PCAVR_NEEDS_SHARED_DATA("real/ur10e");
  PCAVR_NEEDS_SHARED_DATA("real/franka_dynamics");
  PCAVR_NEEDS_SHARED_DATA("real/lbr_med");
  const auto expect_none = [](const std::string& file, const std::string& robot, double gain) {
    JointLogImportOptions options;
    if (file.find("lbr_med") != std::string::npos) options.period = 0.01;
    JointLog read = import_joint_log(shared_data(file), options).value().log;
    if (gain != 0.0) read.torque = gain * read.current;
    const MatchedRobot matched = match_joints(read, read_urdf(shared_data(robot)).value()).value();
    JointSignals signals = joint_signals(reordered(read, matched.columns), {});
    (void)check_hypotheses(signals, matched.model);  // the sign of all torques
    EXPECT_TRUE(find_couplings(signals, matched.model, 0.65).empty()) << file;
  };
  for (const char* run :
       {"20_02_10-30sec_12harm", "20_02_19_14harm50sec", "20_02_06-20sec_10harm"}) {
    expect_none(std::string("real/ur10e/identification_data/ur-") + run + ".csv",
                "real/ur10e/ur10e.urdf", 10.0);
  }
  expect_none("real/franka_dynamics", "real/robots/panda/panda.urdf", 0.0);
  expect_none("real/lbr_med/measurements.csv", "real/lbr_med/med7dock.urdf", 0.0);
}

}  // namespace
}  // namespace pcavr
