// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/arm_dynamics.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pcavr::simulation {
namespace {

constexpr double kControlPeriod = 0.001;      // [s]
constexpr double kControlDampingRatio = 0.8;  // as of the tip on a spring: negligible overshoot
constexpr double kGearLag = 0.001;            // [s] of the gears' deflection behind its torque
constexpr double kCompensationSpeed = 0.02;   // [rad/s] at which friction is compensated in full

/// Friction over 1 N m, with bristles damped as for the least inertia of the joints here.
BristleLaw law_of(const PlantJoint& joint) {
  constexpr double kInertia = 0.05;  // [kg m^2]
  BristleLaw law{.static_coefficient = joint.static_friction,
                 .sliding_coefficient = joint.coulomb_friction,
                 .stribeck_speed = joint.stribeck_speed,
                 .breakaway_deflection = joint.breakaway_deflection};
  law.damping = std::sqrt(law.stiffness() * kInertia);
  return law;
}

}  // namespace

ArmDynamics::ArmDynamics(const PlantArm& arm)
    : arm_(arm),
      actual_(arm.actual),
      described_(arm.described),
      inverse_(arm.described, arm.tip),
      rate_(2.0 * std::numbers::pi * arm.bandwidth),
      since_control_(kControlPeriod) {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(arm.q_start.size());
  q_ = q_command_ = q_before_ = arm.q_start;
  dq_ = ddq_ = tau_ = driving_ = gear_ = gear_rate_ = external_ = zero;
  q_link_ = dq_link_ = dq_command_ = acceleration_ = zero;
  jacobian_.resize(6, q_.size());
  for (const PlantJoint& joint : arm.joints) laws_.push_back(law_of(joint));
  bristles_.assign(laws_.size(), Eigen::Matrix<double, 1, 1>::Zero());
  described_.forward_kinematics(q_);
  q_robot_tip_ = described_.T_base_link(arm.tip).rotation();
  update_tip();
}

void ArmDynamics::update_tip() {
  q_link_ = q_ + gear_;
  dq_link_ = dq_ + gear_rate_;
  actual_.jacobian(q_link_, arm_.tip, jacobian_);
  tip_.p_base = arm_.T_base_robot * actual_.T_base_link(arm_.tip).translation();
  tip_.v_base = arm_.T_base_robot.rotation() * (jacobian_.topRows<3>() * dq_link_);
}

/// Computed torque: the described body's inverse dynamics at the wanted acceleration, gravity
/// included, and a part of the friction.
void ArmDynamics::control(const Eigen::Vector3d& p_base_command) {
  const Pose T_robot_command(q_robot_tip_, arm_.T_base_robot.inverse() * p_base_command);
  q_before_ = q_command_;
  inverse_.follow(T_robot_command, kControlPeriod, q_command_);
  acceleration_ = -dq_command_ / kControlPeriod;
  dq_command_ = (q_command_ - q_before_) / kControlPeriod;
  acceleration_ += dq_command_ / kControlPeriod;
  acceleration_ +=
      rate_ * rate_ * (q_command_ - q_) + 2.0 * kControlDampingRatio * rate_ * (dq_command_ - dq_);
  described_.inverse_dynamics(q_, dq_, acceleration_, tau_);
  for (const std::size_t i : arm_.described.coordinate_joints()) {
    const RobotJoint& joint = arm_.described.joints[i];
    const auto k = static_cast<Eigen::Index>(joint.coordinate);
    const PlantJoint& plant = arm_.joints[joint.coordinate];
    tau_[k] += arm_.compensated_friction *
               (plant.coulomb_friction * std::tanh(dq_command_[k] / kCompensationSpeed) +
                plant.viscous_friction * dq_command_[k]);
    const double limit = joint.limits.effort.value_or(std::abs(tau_[k]));
    tau_[k] = std::clamp(tau_[k], -limit, limit);
  }
}

double ArmDynamics::friction(Eigen::Index joint, double dt) {
  const auto k = static_cast<std::size_t>(joint);
  const Eigen::Matrix<double, 1, 1> speed(dq_[joint]);
  return advance_bristles<1>(laws_[k], speed, dt, bristles_[k])(0) +
         arm_.joints[k].viscous_friction * dq_[joint];
}

void ArmDynamics::advance(const Eigen::Vector3d& p_base_command, const Eigen::Vector3d& force,
                          const Eigen::Vector3d& torque, double dt) {
  since_control_ += dt;
  if (since_control_ >= kControlPeriod * (1.0 - 1e-9)) {
    control(p_base_command);
    since_control_ = 0.0;
  }
  const Eigen::Quaterniond q_robot_base = arm_.T_base_robot.rotation().conjugate();
  external_.noalias() = -jacobian_.topRows<3>().transpose() * (q_robot_base * force);
  external_.noalias() -= jacobian_.bottomRows<3>().transpose() * (q_robot_base * torque);
  for (Eigen::Index k = 0; k < q_.size(); ++k) {
    driving_[k] = tau_[k] - friction(k, dt) + external_[k];
    const double stiffness = arm_.joints[static_cast<std::size_t>(k)].gear_stiffness;
    gear_rate_[k] = (external_[k] / stiffness - gear_[k]) / (kGearLag + dt);
  }
  actual_.forward_dynamics(q_, dq_, driving_, ddq_);
  dq_ += dt * ddq_;
  q_ += dt * dq_;
  gear_ += dt * gear_rate_;
  update_tip();
}

}  // namespace pcavr::simulation
