// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot_identification/drive_gains.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "pcavr/recordings/recording/import_joint_log.hpp"
#include "pcavr/robots/robot/urdf.hpp"
#include "pcavr/robots/robot_identification/log_checks.hpp"
#include "pcavr/robots/robot_identification/payload.hpp"

#include "robot_identification/simulated_arm.hpp"
#include "support/shared_data.hpp"

namespace pcavr {
namespace {

/// Currents in place of torques.
JointSignals currents_of(JointLog log, const Eigen::VectorXd& gain) {
  log.torque *= gain.cwiseInverse().asDiagonal();
  return joint_signals(log, {});
}

TEST(DriveGains, FollowFromALoadOfKnownMass) {
  const RobotModel arm = pa10();
  RigidInertia load;
  load.mass = 3.0;
  load.centre_of_mass = {0.05, -0.02, 0.10};
  load.inertia_at_com = 0.004 * Eigen::Matrix3d::Identity();
  RobotModel loaded = arm;
  loaded.joints.back().body = loaded.joints.back().body + load;
  Eigen::VectorXd gain(7);
  gain << 14.0, 13.0, 11.0, 10.0, 12.0, -9.0, 8.0;
  const JointSignals without = currents_of(simulated_log(arm, {.seed = 41}), gain);
  const JointSignals with = currents_of(simulated_log(loaded, {.seed = 42}), gain);
  // The description's bodies are another arm's.
  RobotModel described = arm;
  for (auto& joint : described.joints) joint.body.mass *= 1.4;
  const DriveGains found = identify_drive_gains(without, with, described, load.mass, {});
  for (Eigen::Index j = 0; j < 7; ++j) {
    EXPECT_NEAR(found.gain[j], gain[j], 3.0 * found.std[j]) << j;
    EXPECT_LT(found.std[j], 0.05 * std::abs(gain[j])) << j;
  }
}

// Both runs' torques are too small, as by gains of a data sheet.
TEST(IdentifyPayload, OfTorquesByGivenGainsStatesAStdThatContainsTheGains) {
  constexpr double kGainError = 0.87;
  const RobotModel arm = pa10();
  RigidInertia load;
  load.mass = 3.0;
  load.centre_of_mass = {0.05, -0.02, 0.10};
  load.inertia_at_com = 0.004 * Eigen::Matrix3d::Identity();
  RobotModel loaded = arm;
  loaded.joints.back().body = loaded.joints.back().body + load;
  JointLog without = simulated_log(arm, {.duration = 15.0, .seed = 43});
  JointLog with = simulated_log(loaded, {.duration = 15.0, .seed = 44});
  without.torque *= kGainError;
  with.torque *= kGainError;
  RobotFitOptions options;
  options.is_extended = false;
  const RobotFit fit = fit_robot(joint_signals(without, {}), arm, options);
  const JointSignals signals = joint_signals(with, {});
  const Payload recorded = identify_payload(signals, arm, fit);
  EXPECT_GT(std::abs(recorded.mass - load.mass), 5.0 * recorded.mass_std);
  const Payload given = identify_payload(signals, arm, fit, given_gain_covariance(7, 0.1));
  EXPECT_EQ(given.mass, recorded.mass);
  EXPECT_LT(std::abs(given.mass - load.mass), 2.0 * given.mass_std);
  EXPECT_LT(given.mass_std, 0.15 * load.mass);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_LT(std::abs(given.centre_of_mass[axis] - load.centre_of_mass[axis]),
              3.0 * given.centre_of_mass_std[axis])
        << axis;
  }
}

JointLog ur10e_log(const char* name) {
  JointLog log =
      import_joint_log(
          shared_data(std::string("real/ur10e/identification_data/ur-20_") + name + ".csv"), {})
          .value()
          .log;
  log.torque = log.current;
  return log;
}

// The gains by the 2.805 kg of one pair of runs weigh the load of another pair.
TEST(DriveGains, OfAUr10eWeighTheLoadOfAnotherPairOfRuns) {
  PCAVR_NEEDS_SHARED_DATA("real/ur10e");
  const JointLog log = ur10e_log("02_19_14harm50sec");
  const RobotModel model =
      match_joints(log, read_urdf(shared_data("real/ur10e/ur10e.urdf")).value()).value().model;
  const DriveGains found =
      identify_drive_gains(joint_signals(log, {}),
                           joint_signals(ur10e_log("02_19_14harm50secLoad"), {}), model, 2.805, {});
  const auto torques_of = [&](const char* name) {
    JointLog run = ur10e_log(name);
    run.torque *= found.gain.asDiagonal();
    return joint_signals(run, {});
  };
  RobotFitOptions options;
  options.train_share = 1.0;
  const RobotFit unloaded = fit_robot(torques_of("01_31-unload"), model, options);
  const Payload load = identify_payload(torques_of("01_31-load"), model, unloaded);
  EXPECT_NEAR(load.mass, 2.805, 0.02 * 2.805);
  EXPECT_NEAR(load.mass, 2.805, 3.0 * load.mass_std);
}

}  // namespace
}  // namespace pcavr
