// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>

#include <Eigen/Cholesky>

#include "pcavr/robot/robot_dynamics.hpp"
#include "pcavr/robot_identification/robot_fit.hpp"

namespace pcavr::detail {

struct MotionState {
  Eigen::VectorXd q, dq;
};

/// Slope of the friction torque over the speed [N m s/rad], not negative.
[[nodiscard]] inline double friction_slope(const JointFit& joint, double q, double v, double load) {
  const double step = 0.1 * joint.smoothing_speed;
  const double change =
      friction_torque(joint, q, v + step, load) - friction_torque(joint, q, v - step, load);
  return std::max(0.0, 0.5 * change / step);
}

/// An arm with friction under joint torques. Keeps a reference to the friction.
class ArmSimulation {
 public:
  ArmSimulation(const std::vector<JointFit>& friction, const RobotModel& model)
      : friction_(friction), dynamics_(model), dof_(static_cast<Eigen::Index>(model.dof)) {
    mass_.resize(dof_, dof_);
    bias_.resize(dof_);
    zero_.setZero(dof_);
  }

  /// One linearly implicit step: wrists have so little inertia that their friction decays within
  /// tens of microseconds, for which explicit steps would be too long.
  void step(MotionState& state, const Eigen::VectorXd& torque, double dt) {
    dynamics_.mass_matrix(state.q, mass_);
    dynamics_.inverse_dynamics(state.q, state.dq, zero_, bias_);
    Eigen::VectorXd net = torque - bias_;
    for (Eigen::Index j = 0; j < dof_; ++j) {
      const JointFit& joint = friction_[static_cast<std::size_t>(j)];
      net[j] -= friction_torque(joint, state.q[j], state.dq[j], bias_[j]);
      mass_(j, j) += dt * friction_slope(joint, state.q[j], state.dq[j], bias_[j]);
    }
    const Eigen::VectorXd change = dt * mass_.ldlt().solve(net);
    state.q += dt * (state.dq + 0.5 * change);
    state.dq += change;
  }

 private:
  const std::vector<JointFit>& friction_;
  RobotDynamics dynamics_;
  Eigen::Index dof_;
  Eigen::MatrixXd mass_;
  Eigen::VectorXd bias_, zero_;
};

}  // namespace pcavr::detail
