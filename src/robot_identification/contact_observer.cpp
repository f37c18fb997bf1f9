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

}  // namespace

ContactObserver::ContactObserver(const RobotModel& robot, const std::vector<JointFit>& friction,
                                 const ContactObserverOptions& options)
    : dynamics_(robot), friction_(friction), gain_(options.gain) {
  const auto dof = static_cast<Eigen::Index>(dynamics_.dof());
  for (Eigen::VectorXd* vector : {&external_, &integral_, &momentum_, &start_, &rate_, &ahead_,
                                  &behind_, &zero_, &gravity_, &bias_, &q_shifted_}) {
    vector->setZero(dof);
  }
}

void ContactObserver::compute_momentum(const Vector& q, const Vector& dq,
                                       Eigen::VectorXd& momentum) {
  dynamics_.inverse_dynamics(q, zero_, dq, momentum);
  dynamics_.gravity_torque(q, gravity_);
  momentum -= gravity_;
}

void ContactObserver::reset(const Vector& q, const Vector& dq) {
  compute_momentum(q, dq, start_);
  integral_.setZero();
  external_.setZero();
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
    rate_[j] -= friction_torque(friction_[static_cast<std::size_t>(j)], q[j], dq[j], bias_[j]);
  }
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
  std::vector<bool> is_settled;
};

double usual_interval(const std::vector<double>& t) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < t.size(); ++i) intervals.push_back(t[i] - t[i - 1]);
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return *middle;
}

ObservedRows observe_rows(const JointLog& log, ContactObserver& observer, double sign,
                          const ContactObserverOptions& options) {
  const Eigen::Index rows = log.position.rows();
  ObservedRows observed{Eigen::MatrixXd::Zero(rows, log.position.cols()),
                        std::vector<bool>(static_cast<std::size_t>(rows), false)};
  const bool has_velocity = log.velocity.rows() == rows;
  const double max_interval = kGapIntervals * usual_interval(log.t);
  double started = log.t.front();
  Eigen::VectorXd q = log.position.row(0).transpose();
  Eigen::VectorXd dq = Eigen::VectorXd::Zero(q.size());
  if (has_velocity) dq = log.velocity.row(0).transpose();
  observer.reset(q, dq);
  for (Eigen::Index i = 1; i < rows; ++i) {
    const auto row = static_cast<std::size_t>(i);
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
    observed.is_settled[row] = log.t[row] - started > kSettlingTimes / options.gain;
  }
  return observed;
}

/// Onsets of rows above a threshold; the arm is free again after the same time below all of them.
void find_touches(const JointLog& log, const ObservedRows& observed, double min_duration,
                  ObservedContacts& found) {
  double above_since = -1.0;
  double below_since = log.t[found.first_judged];
  bool is_above = false;
  bool is_touching = false;
  for (std::size_t row = found.first_judged; row < log.t.size(); ++row) {
    const Eigen::VectorXd ratio = observed.external.row(static_cast<Eigen::Index>(row))
                                      .transpose()
                                      .cwiseAbs()
                                      .cwiseQuotient(found.thresholds);
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
  ContactObserver observer(fit.robot(described), fit.joints, options);
  ObservedRows observed = observe_rows(log, observer, is_sign_changed ? -1.0 : 1.0, options);
  ObservedContacts found;
  found.thresholds = Eigen::VectorXd::Zero(log.position.cols());
  while (found.first_judged + 1 < log.t.size() && log.t[found.first_judged] < calibration_end) {
    if (observed.is_settled[found.first_judged]) {
      found.thresholds = found.thresholds.cwiseMax(
          observed.external.row(static_cast<Eigen::Index>(found.first_judged))
              .transpose()
              .cwiseAbs());
    }
    ++found.first_judged;
  }
  // Never 0, which no torque could stay below.
  found.thresholds = (options.margin * found.thresholds).cwiseMax(1e-6);
  find_touches(log, observed, options.min_duration, found);
  found.external = std::move(observed.external);
  add_forces(log, described, tip, found);
  return found;
}

}  // namespace pcavr
