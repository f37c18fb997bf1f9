// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot_identification/contact_observer.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/core/solvers.hpp"

namespace pcavr {
namespace {

/// [s] of motion between the two mass matrices whose difference gives M's derivative: their
/// rounding errors are 1e-10 of it, and its own error grows with the square.
constexpr double kMassStep = 1e-4;
/// A joint that has not moved by this displacement [rad] for this time [s] rests.
constexpr double kRestDisplacement = 0.5e-3;
constexpr double kRestTime = 0.1;

}  // namespace

ContactObserver::ContactObserver(const RobotModel& robot, const std::vector<JointFit>& friction,
                                 const ContactObserverOptions& options)
    : dynamics_(robot), friction_(friction), gain_(options.gain) {
  const auto dof = static_cast<Eigen::Index>(dynamics_.dof());
  for (Eigen::VectorXd* vector :
       {&external_, &integral_, &momentum_, &start_, &rate_, &ahead_, &behind_, &zero_, &gravity_,
        &bias_, &q_shifted_, &unresolved_, &last_momentum_, &last_rate_, &last_step_,
        &last_rate_step_, &rest_position_, &rest_time_}) {
    vector->setZero(dof);
  }
  for (const JointFit& joint : friction_) signs_.emplace_back(joint.sign);
}

void ContactObserver::compute_momentum(const Vector& q, const Vector& dq,
                                       Eigen::VectorXd& momentum) {
  dynamics_.inverse_dynamics(q, zero_, dq, momentum);
  dynamics_.gravity_torque(q, gravity_);
  momentum -= gravity_;
}

void ContactObserver::reset(const Vector& q, const Vector& dq) {
  compute_momentum(q, dq, start_);
  signs_.clear();
  for (std::size_t j = 0; j < friction_.size(); ++j) {
    // Moving for long, so far as is known.
    const double v = dq[static_cast<Eigen::Index>(j)];
    signs_.emplace_back(friction_[j].sign, std::tanh(v / friction_[j].sign.smoothing_speed));
  }
  integral_.setZero();
  external_.setZero();
  unresolved_.setZero();
  rest_position_ = q;
  rest_time_.setZero();
  samples_ = 0;
}

/// Friction holds a joint at rest against torques up to Coulomb's, and creeps there: its sign is
/// not known, and as much of an external torque is not.
void ContactObserver::update_rest(const Vector& q, double dt) {
  for (Eigen::Index j = 0; j < q.size(); ++j) {
    rest_time_[j] += dt;
    if (std::abs(q[j] - rest_position_[j]) > kRestDisplacement) {
      rest_position_[j] = q[j];
      rest_time_[j] = 0.0;
    }
    if (rest_time_[j] < kRestTime) continue;
    const auto index = static_cast<std::size_t>(j);
    const JointFit& joint = friction_[index];
    signs_[index] = FrictionSign(joint.sign);
    const double range = friction_torque(joint, q[j], 0.0, bias_[j], 1.0) -
                         friction_torque(joint, q[j], 0.0, bias_[j], -1.0);
    unresolved_[j] = std::max(unresolved_[j], 0.5 * std::abs(range));
  }
}

/// Updates the part that the samples do not resolve, which is the departure from the straight
/// continuation of the last two: in the step of the momentum, and in half of the step of the torque
/// over the interval.
void ContactObserver::update_unresolved(double dt) {
  // Single changes count fully, noise by the root of its squares' sum.
  if (samples_ > 1) {
    const double decay = 1.0 / (1.0 + gain_ * dt);
    unresolved_ =
        decay * (unresolved_.array().square() +
                 (gain_ * ((momentum_ - last_momentum_ - last_step_).array().abs() +
                           0.5 * dt * (rate_ - last_rate_ - last_rate_step_).array().abs()))
                     .square())
                    .sqrt();
  }
  if (samples_ > 0) {
    last_step_ = momentum_ - last_momentum_;
    last_rate_step_ = rate_ - last_rate_;
  }
  last_momentum_ = momentum_;
  last_rate_ = rate_;
  ++samples_;
}

const Eigen::VectorXd& ContactObserver::update(const Vector& q, const Vector& dq, const Vector& tau,
                                               double dt) {
  q_shifted_ = q + kMassStep * dq;
  compute_momentum(q_shifted_, dq, ahead_);
  q_shifted_ = q - kMassStep * dq;
  compute_momentum(q_shifted_, dq, behind_);
  compute_momentum(q, dq, momentum_);
  dynamics_.inverse_dynamics(q, dq, zero_, bias_);  // C dq + g
  rate_ = tau + (ahead_ - behind_) / (2.0 * kMassStep) - bias_;
  for (Eigen::Index j = 0; j < rate_.size(); ++j) {
    const auto index = static_cast<std::size_t>(j);
    signs_[index].move(dt * dq[j]);
    rate_[j] -= friction_torque(friction_[index], q[j], dq[j], bias_[j], signs_[index].at(dq[j]));
  }
  update_unresolved(dt);
  update_rest(q, dt);
  integral_ += dt * rate_;
  // Implicit in the external torque: stable for any interval.
  external_ = (gain_ / (1.0 + gain_ * dt)) * (momentum_ - start_ - integral_);
  integral_ += dt * external_;
  return external_;
}

std::optional<Eigen::Vector3d> tip_force(const Matrix6Xd& jacobian, const Eigen::VectorXd& external,
                                         const Eigen::VectorXd& thresholds) {
  const Eigen::MatrixXd weighted =
      thresholds.cwiseInverse().asDiagonal() * jacobian.topRows<3>().transpose();
  const Eigen::Matrix3d normal = weighted.transpose() * weighted;
  const Eigen::LDLT<Eigen::Matrix3d> solver(normal);
  const double min_pivot = 1e-6 * normal.trace();
  if (!(solver.vectorD().minCoeff() > min_pivot)) return std::nullopt;
  return solver.solve(weighted.transpose() * external.cwiseQuotient(thresholds));
}

}  // namespace pcavr
