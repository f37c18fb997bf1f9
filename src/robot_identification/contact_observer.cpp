// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robot_identification/contact_observer.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace pcavr {
namespace {

/// [s] of motion between the two mass matrices whose difference gives M's derivative: their
/// rounding errors are 1e-10 of it, and its own error grows with the square.
constexpr double kMassStep = 1e-4;
/// The observer needs so many time constants until its start is forgotten.
constexpr double kSettlingTimes = 5.0;
/// Intervals longer than so many medians are gaps: the observer starts anew.
constexpr double kGapIntervals = 10.0;
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

/// Of the straight continuation of the last two samples: the step of the momentum, and half of the
/// step of the torque over the interval.
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

namespace {

/// The observer's rows, and where it started anew.
struct ObservedRows {
  Eigen::MatrixXd external;
  Eigen::MatrixXd unresolved;
  std::vector<bool> is_settled;
};

double usual_interval(const std::vector<double>& t) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < t.size(); ++i) intervals.push_back(t[i] - t[i - 1]);
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return *middle;
}

/// Rows `begin` to `end`; the others stay 0.
ObservedRows observe_rows(const JointLog& log, std::size_t begin, std::size_t end,
                          ContactObserver observer, double sign,
                          const ContactObserverOptions& options) {
  const Eigen::Index rows = log.position.rows();
  ObservedRows observed{Eigen::MatrixXd::Zero(rows, log.position.cols()),
                        Eigen::MatrixXd::Zero(rows, log.position.cols()),
                        std::vector<bool>(static_cast<std::size_t>(rows), false)};
  const bool has_velocity = log.velocity.rows() == rows;
  const double max_interval = kGapIntervals * usual_interval(log.t);
  double started = log.t[begin];
  const auto first = static_cast<Eigen::Index>(begin);
  Eigen::VectorXd q = log.position.row(first).transpose();
  Eigen::VectorXd dq = Eigen::VectorXd::Zero(q.size());
  if (has_velocity) dq = log.velocity.row(first).transpose();
  observer.reset(q, dq);
  for (std::size_t row = begin + 1; row < end; ++row) {
    const auto i = static_cast<Eigen::Index>(row);
    const double dt = log.t[row] - log.t[row - 1];
    q = log.position.row(i).transpose();
    dq = (log.position.row(i) - log.position.row(i - 1)).transpose() / dt;
    if (has_velocity) dq = log.velocity.row(i).transpose();
    if (dt > max_interval) {
      observer.reset(q, dq);
      started = log.t[row];
      continue;
    }
    observed.external.row(i) =
        observer.update(q, dq, sign * log.torque.row(i).transpose(), dt).transpose();
    observed.unresolved.row(i) = observer.unresolved().transpose();
    observed.is_settled[row] = log.t[row] - started > kSettlingTimes / options.gain;
  }
  return observed;
}

/// The largest external torques [N m] by joint of the rows that the observer's start left.
Eigen::VectorXd largest_of(const ObservedRows& observed, std::size_t begin, std::size_t end) {
  Eigen::VectorXd largest = Eigen::VectorXd::Zero(observed.external.cols());
  for (std::size_t row = begin; row < end; ++row) {
    if (!observed.is_settled[row]) continue;
    largest = largest.cwiseMax(
        observed.external.row(static_cast<Eigen::Index>(row)).transpose().cwiseAbs());
  }
  return largest;
}

/// Onsets of rows above a threshold; the arm is free again after the same time below all of them.
void find_touches(const JointLog& log, const ObservedRows& observed, double min_duration,
                  ObservedContacts& found) {
  double above_since = -1.0;
  double below_since = log.t[found.first_judged];
  bool is_above = false;
  bool is_touching = false;
  for (std::size_t row = found.first_judged; row < log.t.size(); ++row) {
    const auto i = static_cast<Eigen::Index>(row);
    // Unresolved torques count from half a threshold on, and fully where they alone would be a
    // touch.
    const Eigen::ArrayXd unresolved =
        observed.unresolved.row(i).transpose().array() / found.thresholds.array();
    const Eigen::ArrayXd external =
        observed.external.row(i).transpose().array().abs() / found.thresholds.array();
    const Eigen::ArrayXd ratio = external - (2.0 * unresolved - 1.0).max(0.0).min(unresolved);
    Eigen::Index joint = 0;
    const bool exceeds = observed.is_settled[row] && ratio.maxCoeff(&joint) > 1.0;
    if (exceeds && !is_above) above_since = log.t[row];
    if (!exceeds && is_above) below_since = log.t[row];
    is_above = exceeds;
    if (exceeds && !is_touching && log.t[row] - above_since >= min_duration) {
      is_touching = true;
      found.touches.push_back({log.t[row], static_cast<std::size_t>(joint), std::nullopt});
    }
    if (!exceeds && is_touching && log.t[row] - below_since >= 10.0 * min_duration) {
      is_touching = false;
    }
  }
}

/// Adds the forces of the touches, and the force that can be detected.
void add_forces(const JointLog& log, const RobotModel& model, std::size_t tip,
                ObservedContacts& found) {
  RobotDynamics kinematics(model);
  Matrix6Xd jacobian(6, log.position.cols());
  const auto jacobian_at = [&](std::size_t row) {
    const Eigen::VectorXd q = log.position.row(static_cast<Eigen::Index>(row)).transpose();
    kinematics.jacobian(q, tip, jacobian);
  };
  for (ObservedContacts::Touch& touch : found.touches) {
    const auto at = std::lower_bound(log.t.begin(), log.t.end(), touch.t);
    const auto row = static_cast<std::size_t>(at - log.t.begin());
    jacobian_at(row);
    touch.force_base = tip_force(
        jacobian, found.external.row(static_cast<Eigen::Index>(row)).transpose(), found.thresholds);
  }
  constexpr std::size_t kSamples = 200;
  const std::size_t step = std::max<std::size_t>(1, (log.t.size() - found.first_judged) / kSamples);
  std::size_t count = 0;
  for (std::size_t row = found.first_judged; row < log.t.size(); row += step, ++count) {
    jacobian_at(row);
    double largest = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double share =
          jacobian.row(axis).transpose().cwiseAbs().cwiseQuotient(found.thresholds).maxCoeff();
      largest = std::max(largest, 1.0 / share);
    }
    found.detectable_force += largest;
  }
  if (count > 0) found.detectable_force /= static_cast<double>(count);
}

}  // namespace

ObservedContacts observe_contacts(const JointLog& log, const RobotModel& described,
                                  const RobotFit& fit, bool is_sign_changed, double calibration_end,
                                  std::size_t tip, const ContactObserverOptions& options) {
  const double sign = is_sign_changed ? -1.0 : 1.0;
  const auto row_at = [&](double t) {
    return static_cast<std::size_t>(std::lower_bound(log.t.begin(), log.t.end(), t) -
                                    log.t.begin());
  };
  ObservedRows observed =
      observe_rows(log, 0, log.t.size(), ContactObserver(fit.robot(described), fit.joints, options),
                   sign, options);
  ObservedContacts found;
  found.first_judged = std::min(row_at(calibration_end), log.t.size() - 1);
  found.thresholds = largest_of(observed, 0, found.first_judged);
  for (const LeftOutFit& left_out : fit.left_out) {
    const std::size_t begin = row_at(left_out.begin);
    const std::size_t end = std::min(row_at(left_out.end), found.first_judged);
    if (begin >= end) continue;
    const ContactObserver observer(
        fitted_robot(described, left_out.inertial_parameters, left_out.joints), left_out.joints,
        options);
    found.thresholds = found.thresholds.cwiseMax(
        largest_of(observe_rows(log, begin, end, observer, sign, options), begin, end));
  }
  // Never 0, which no torque could stay below.
  found.thresholds = (options.margin * found.thresholds).cwiseMax(1e-6);
  find_touches(log, observed, options.min_duration, found);
  found.external = std::move(observed.external);
  add_forces(log, described, tip, found);
  return found;
}

}  // namespace pcavr
