// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/robots/robot/robot_model.hpp"
#include "pcavr/robots/robot_identification/joint_signals.hpp"
#include "pcavr/robots/robot_identification/robot_fit.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// Defaults and ranges: src/robots/robot_identification/options.cpp.
struct FrictionTrialOptions {
  FrictionTrialOptions();
  double stretch;        ///< [s] simulated from a recorded state
  int stretches;         ///< evenly over the fitted part
  bool is_viscous_only;  ///< no Coulomb friction: one parameter a joint [paper A]
};
[[nodiscard]] OptionSection section_of(FrictionTrialOptions& options);

/// Friction by joint that one stage of the trial found.
struct TrialStage {
  std::vector<JointFit> joints;  ///< viscous and Coulomb friction, without std; torque errors
  Eigen::VectorXd position_rms;  ///< [rad] by joint, of the simulated stretches
};

/// Paper A's "prove and error": torques in, positions out, friction changed until the simulated
/// positions fit the recorded ones.
struct FrictionTrial {
  TrialStage alone;             ///< one joint moves by its torque, the others as recorded
  TrialStage together;          ///< from there on, all joints move by their torques
  double simulated_time = 0.0;  ///< [s] of motion, of all trials
  double alone_share = 0.0;     ///< of it that simulates one joint
};

/// Tries viscous and Coulomb friction of each joint on a grid that is refined about the best, then
/// moves one value after the other while all joints are simulated. The bodies, the motor inertia,
/// the torques' lag and the speed of the sign are `fit`'s; only its fitted rows are tried on, the
/// others are judged by torque. The others of A's joints were braked; here they follow the record,
/// so that a log in which all move will do. Nothing where no stretch of the
/// fitted rows is free of gaps. Deterministic; pure function.
[[nodiscard]] std::optional<FrictionTrial> try_friction(const JointSignals& signals,
                                                        const RobotModel& described,
                                                        const RobotFit& fit,
                                                        const FrictionTrialOptions& options = {});

}  // namespace pcavr
