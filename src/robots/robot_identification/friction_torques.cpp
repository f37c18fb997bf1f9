// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "robots/robot_identification/friction_torques.hpp"

#include <cmath>
#include <vector>

#include "pcavr/robots/robot/robot_dynamics.hpp"

namespace pcavr::detail {

FrictionTorques friction_torques(const JointSignals& signals, const RobotModel& robot,
                                 const RobotFit& fit) {
  FrictionTorques torques{signals.torque, signals.torque, signals.torque};
  std::vector<double> later = signals.t;
  for (double& t : later) t += fit.torque_lag;
  RobotModel bodies = robot;
  for (RobotJoint& joint : bodies.joints) joint.armature = 0.0;
  RobotDynamics dynamics(bodies);
  Eigen::VectorXd rigid(signals.torque.cols());
  for (Eigen::Index j = 0; j < rigid.size() && fit.torque_lag != 0.0; ++j) {
    torques.measured.col(j) = interpolate(signals.t, signals.torque.col(j), later);
  }
  for (Eigen::Index row = 0; row < torques.rigid.rows(); ++row) {
    dynamics.inverse_dynamics(signals.position.row(row).transpose(),
                              signals.velocity.row(row).transpose(),
                              signals.acceleration.row(row).transpose(), rigid);
    torques.rigid.row(row) = rigid.transpose();
  }
  torques.friction = torques.measured - torques.rigid;
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    const auto column = static_cast<Eigen::Index>(j);
    torques.friction.col(column) -= robot.joints[j].armature * signals.acceleration.col(column);
  }
  return torques;
}

TorqueError torque_error(const Eigen::VectorXd& residual, const Eigen::VectorXd& measured) {
  if (residual.size() == 0) return {};
  return {residual.norm() / std::sqrt(static_cast<double>(residual.size())),
          residual.norm() / measured.norm()};
}

void set_torque_errors(const JointSignals& signals, const FrictionTorques& torques,
                       std::size_t train_rows, std::size_t index, JointFit& joint) {
  const auto j = static_cast<Eigen::Index>(index);
  const auto train = static_cast<Eigen::Index>(train_rows);
  Eigen::VectorXd residual = torques.friction.col(j);
  const Eigen::VectorXd sign = friction_sign(joint.sign, signals, index);
  for (Eigen::Index row = 0; row < residual.size(); ++row) {
    residual[row] -= friction_torque(joint, signals.position(row, j), signals.velocity(row, j),
                                     torques.rigid(row, j), sign[row]);
  }
  const Eigen::Index rest = residual.size() - train;
  joint.train = torque_error(residual.head(train), torques.measured.col(j).head(train));
  joint.held_out = torque_error(residual.tail(rest), torques.measured.col(j).tail(rest));
}

}  // namespace pcavr::detail
