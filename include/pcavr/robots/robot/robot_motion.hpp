// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "pcavr/robots/robot/robot_dynamics.hpp"

namespace pcavr {

/// Integrates M(q) ddq + C(q, dq) dq + g(q) = tau under a constant torque by the classical
/// Runge-Kutta method of fourth order [Kutta 1901]: four evaluations of the forward dynamics a
/// step. At 1 kHz a free swinging arm keeps its energy to some 1e-9 in 10 s. Does not know limits
/// or friction: what depends on the velocity goes into the torque, step by step. After the
/// constructor nothing allocates. Threads: one at a time per object.
class RobotMotion {
 public:
  explicit RobotMotion(const RobotModel& model);

  /// Moves q and dq on by `dt` [s], > 0.
  void step(const Eigen::Ref<const Eigen::VectorXd>& tau, double dt, Eigen::Ref<Eigen::VectorXd> q,
            Eigen::Ref<Eigen::VectorXd> dq);

  [[nodiscard]] RobotDynamics& dynamics() { return dynamics_; }

 private:
  RobotDynamics dynamics_;
  Eigen::VectorXd q_;
  Eigen::VectorXd dq_;
  Eigen::VectorXd ddq_;
  Eigen::VectorXd dq_sum_;
  Eigen::VectorXd ddq_sum_;
};

}  // namespace pcavr
