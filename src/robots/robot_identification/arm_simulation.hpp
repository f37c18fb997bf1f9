// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>

#include "pcavr/base/core/solvers.hpp"
#include "pcavr/robots/robot/robot_dynamics.hpp"
#include "pcavr/robots/robot_identification/robot_fit.hpp"

namespace pcavr::detail {

struct MotionState {
  Eigen::VectorXd q, dq;
};

/// The values that the record prescribes at the middle of a step.
struct RecordedStep {
  Eigen::VectorXd q, dq, ddq, torque;
};

/// Change of the friction torque over that of the speed within `dt` [s], [N m s/rad], not negative.
[[nodiscard]] inline double friction_slope(const JointFit& joint, const FrictionSign& sign,
                                           double q, double v, double load, double dt) {
  const double step = 0.1 * joint.sign.smoothing_speed;
  const auto torque = [&](double speed, double its_sign) {
    return friction_torque(joint, q, speed, load, its_sign);
  };
  const double by_speed =
      (torque(v + step, sign.at(v + step)) - torque(v - step, sign.at(v - step))) / (2.0 * step);
  const double by_sign = 0.5 * (torque(v, 1.0) - torque(v, -1.0));
  return std::max(0.0, by_speed + by_sign * sign.slope(v) * dt);
}

/// An arm with friction under joint torques. Keeps a reference to the friction.
class ArmSimulation {
 public:
  /// `signs`: of friction that has a state, at the start; 0 where there are none.
  ArmSimulation(const std::vector<JointFit>& friction, const RobotModel& model,
                const Eigen::VectorXd& signs = {})
      : friction_(friction), dynamics_(model), dof_(static_cast<Eigen::Index>(model.dof)) {
    for (Eigen::Index j = 0; j < dof_; ++j) {
      signs_.emplace_back(friction[static_cast<std::size_t>(j)].sign,
                          signs.size() > 0 ? signs[j] : 0.0);
    }
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
      const auto index = static_cast<std::size_t>(j);
      const JointFit& joint = friction_[index];
      const FrictionSign& sign = signs_[index];
      const double q = state.q[j], v = state.dq[j];
      net[j] -= friction_torque(joint, q, v, bias_[j], sign.at(v));
      mass_(j, j) += dt * friction_slope(joint, sign, q, v, bias_[j], dt);
    }
    const Eigen::VectorXd change = dt * mass_.ldlt().solve(net);
    const Eigen::VectorXd moved = dt * (state.dq + 0.5 * change);
    for (Eigen::Index j = 0; j < dof_; ++j) signs_[static_cast<std::size_t>(j)].move(moved[j]);
    state.q += moved;
    state.dq += change;
  }

 private:
  const std::vector<JointFit>& friction_;
  std::vector<FrictionSign> signs_;
  RobotDynamics dynamics_;
  Eigen::Index dof_;
  Eigen::MatrixXd mass_;
  Eigen::VectorXd bias_, zero_;
};

/// One joint under its torque, while the others follow the record.
class JointSimulation {
 public:
  JointSimulation(const RobotModel& model, Eigen::Index joint) : dynamics_(model), joint_(joint) {
    const auto dof = static_cast<Eigen::Index>(model.dof);
    mass_.resize(dof, dof);
    torque_.resize(dof);
  }

  /// [kg m^2] It does not depend on the joint's own position.
  [[nodiscard]] double inertia(const RecordedStep& recorded) {
    dynamics_.mass_matrix(recorded.q, mass_);
    return mass_(joint_, joint_);
  }

  /// One linearly implicit step of the joint's position `q` and speed `v`.
  void step(const RecordedStep& recorded, double inertia, const JointFit& friction,
            FrictionSign& sign, double dt, double& q, double& v) {
    q_ = recorded.q;
    dq_ = recorded.dq;
    ddq_ = recorded.ddq;
    q_[joint_] = q + 0.5 * dt * v;
    dq_[joint_] = v;
    ddq_[joint_] = 0.0;
    dynamics_.inverse_dynamics(q_, dq_, ddq_, torque_);
    const double load = torque_[joint_];
    const double net =
        recorded.torque[joint_] - load - friction_torque(friction, q_[joint_], v, load, sign.at(v));
    const double slope = friction_slope(friction, sign, q_[joint_], v, load, dt);
    const double change = dt * net / (inertia + dt * slope);
    const double moved = dt * (v + 0.5 * change);
    sign.move(moved);
    q += moved;
    v += change;
  }

 private:
  RobotDynamics dynamics_;
  Eigen::Index joint_;
  Eigen::MatrixXd mass_;
  Eigen::VectorXd q_, dq_, ddq_, torque_;
};

}  // namespace pcavr::detail
