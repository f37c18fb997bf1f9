// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include <Eigen/Core>

#include "pcavr/robots/robot_identification/joint_signals.hpp"
#include "pcavr/robots/robot_identification/robot_fit.hpp"

namespace pcavr::detail {

/// Row by row of the signals, one column a joint [N m].
struct FrictionTorques {
  Eigen::MatrixXd measured;  ///< torques without their lag
  Eigen::MatrixXd rigid;     ///< of the bodies
  Eigen::MatrixXd friction;  ///< measured less rigid and motor inertia's
};

/// `robot`: identified (RobotFit::robot).
[[nodiscard]] FrictionTorques friction_torques(const JointSignals& signals, const RobotModel& robot,
                                               const RobotFit& fit);

/// rms of a residual over rows, and over the rms of the measured torque; 0 for no rows.
[[nodiscard]] TorqueError torque_error(const Eigen::VectorXd& residual,
                                       const Eigen::VectorXd& measured);

/// Sets the errors of the first `train_rows` and of the others for a joint's friction.
void set_torque_errors(const JointSignals& signals, const FrictionTorques& torques,
                       std::size_t train_rows, std::size_t index, JointFit& joint);

}  // namespace pcavr::detail
