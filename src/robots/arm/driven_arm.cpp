// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/arm/driven_arm.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "pcavr/base/core/check.hpp"

namespace pcavr {
namespace {

constexpr double kMaxDrivenStep = 0.5e-3;     // [s] as of the replay of torques
constexpr double kDescribedSmoothing = 0.01;  // [rad/s] of Coulomb friction's sign

RobotModel with_rotors(RobotModel robot, double inertia_per_torque) {
  for (RobotJoint& joint : robot.joints) {
    if (joint.armature > 0.0 || !joint.limits.effort) continue;
    joint.armature = inertia_per_torque * *joint.limits.effort;
  }
  return robot;
}

double slope_of_friction(const JointFit& joint, double q, double v, double load) {
  const double step = 0.1 * joint.sign.smoothing_speed;
  const double change =
      friction_torque(joint, q, v + step, load) - friction_torque(joint, q, v - step, load);
  return std::max(0.0, 0.5 * change / step);
}

}  // namespace

JointFit described_friction(const RobotJoint& joint) {
  JointFit fit;
  fit.name = joint.name;
  fit.sign.smoothing_speed = kDescribedSmoothing;
  fit.friction = {{.term = FrictionTerm::coulomb, .value = joint.friction},
                  {.term = FrictionTerm::viscous, .value = joint.damping}};
  return fit;
}

DrivenArm::DrivenArm(const RobotModel& robot, const std::vector<JointFit>& friction,
                     const DrivenArmOptions& options)
    : dynamics_(with_rotors(robot, options.rotor_inertia_per_torque)),
      friction_(friction),
      rate_(2.0 * std::numbers::pi * options.bandwidth),
      damping_(2.0 * options.damping_ratio * rate_) {
  PCAVR_REQUIRE(robot.has_inertia());
  PCAVR_REQUIRE(friction.empty() || friction.size() == robot.dof, friction.size(), robot.dof);
  const auto dof = static_cast<Eigen::Index>(robot.dof);
  constexpr double kNoLimit = std::numeric_limits<double>::infinity();
  effort_ = upper_ = Eigen::VectorXd::Constant(dof, kNoLimit);
  lower_ = -upper_;
  for (const std::size_t i : robot.coordinate_joints()) {
    const RobotJoint& joint = robot.joints[i];
    const auto k = static_cast<Eigen::Index>(joint.coordinate);
    effort_[k] = joint.limits.effort.value_or(kNoLimit);
    lower_[k] = joint.limits.lower.value_or(-kNoLimit);
    upper_[k] = joint.limits.upper.value_or(kNoLimit);
    if (friction.empty()) friction_.push_back(described_friction(joint));
  }
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(dof);
  q_ = dq_ = tau_ = q_command_ = dq_command_ = wanted_ = bias_ = net_ = zero;
  mass_ = Eigen::MatrixXd::Identity(dof, dof);
  factor_.compute(mass_);
}

void DrivenArm::reset(const Vector& q) {
  q_ = q_command_ = q;
  dq_.setZero();
  dq_command_.setZero();
  dynamics_.gravity_torque(q_, tau_);
  torque_ratio_ = 0.0;
}

void DrivenArm::control(const Vector& q_command, double dt) {
  dq_command_ = (q_command - q_command_) / dt;
  q_command_ = q_command;
  wanted_ = rate_ * rate_ * (q_command_ - q_) + damping_ * (dq_command_ - dq_);
  dynamics_.inverse_dynamics(q_, dq_, wanted_, tau_);
  torque_ratio_ = 0.0;
  for (Eigen::Index j = 0; j < q_.size(); ++j) {
    const auto joint = static_cast<std::size_t>(j);
    tau_[j] += friction_torque(friction_[joint], q_[j], dq_command_[j], tau_[j]);
    const double ratio = std::abs(tau_[j]) / effort_[j];
    if (ratio > torque_ratio_) {
      torque_ratio_ = ratio;
      loaded_joint_ = joint;
    }
    tau_[j] = std::clamp(tau_[j], -effort_[j], effort_[j]);
  }
}

void DrivenArm::advance(const Vector& external, double dt) {
  wanted_.setZero();
  dynamics_.mass_matrix(q_, mass_);
  dynamics_.inverse_dynamics(q_, dq_, wanted_, bias_);
  net_ = tau_ + external - bias_;
  for (Eigen::Index j = 0; j < q_.size(); ++j) {
    const JointFit& joint = friction_[static_cast<std::size_t>(j)];
    net_[j] -= friction_torque(joint, q_[j], dq_[j], bias_[j]);
    mass_(j, j) += dt * slope_of_friction(joint, q_[j], dq_[j], bias_[j]);
  }
  factor_.compute(mass_);
  factor_.solveInPlace(net_);
  q_ += dt * (dq_ + 0.5 * dt * net_);
  dq_ += dt * net_;
  stop_at_limits();
}

void DrivenArm::stop_at_limits() {
  for (Eigen::Index j = 0; j < q_.size(); ++j) {
    const double within = std::clamp(q_[j], lower_[j], upper_[j]);
    if (within == q_[j]) continue;
    q_[j] = within;
    dq_[j] = 0.0;
  }
}

void DrivenArm::step(const Vector& q_command, const Vector& external, double dt) {
  PCAVR_REQUIRE(dt > 0.0 && q_command.size() == q_.size() && external.size() == q_.size(), dt);
  control(q_command, dt);
  const int steps = static_cast<int>(std::ceil(dt / kMaxDrivenStep * (1.0 - 1e-9)));
  for (int i = 0; i < steps; ++i) advance(external, dt / steps);
}

}  // namespace pcavr
