// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "robots/robot_identification/observed_rows.hpp"

#include <algorithm>

namespace pcavr {
namespace {

/// The observer needs so many time constants until its start is forgotten.
constexpr double kSettlingTimes = 5.0;
/// The further low pass starts at the observer's settled value: its error is within a threshold
/// then, and is behind so many time constants a twentieth of that.
constexpr double kFilterSettlingTimes = 3.0;
/// Intervals longer than so many medians are gaps: the observer starts anew.
constexpr double kGapIntervals = 10.0;

double usual_interval(const std::vector<double>& t) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < t.size(); ++i) intervals.push_back(t[i] - t[i - 1]);
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return *middle;
}

}  // namespace

ObservedRows::ObservedRows(Eigen::Index rows, Eigen::Index joints)
    : external(Eigen::MatrixXd::Zero(rows, joints)),
      unresolved(external),
      filtered(external),
      filtered_unresolved(external),
      age(static_cast<std::size_t>(rows), 0.0) {}

bool ObservedRows::is_settled(std::size_t row, const ContactObserverOptions& options) const {
  return age[row] > kSettlingTimes / options.gain;
}

bool ObservedRows::is_filter_settled(std::size_t row, const ContactObserverOptions& options) const {
  return age[row] > settling_time(options);
}

void ObservedRows::take(const ObservedRows& other, RowRange range) {
  const auto first = static_cast<Eigen::Index>(range.begin);
  const auto rows = static_cast<Eigen::Index>(range.end - range.begin);
  external.middleRows(first, rows) = other.external.middleRows(first, rows);
  unresolved.middleRows(first, rows) = other.unresolved.middleRows(first, rows);
  filtered.middleRows(first, rows) = other.filtered.middleRows(first, rows);
  filtered_unresolved.middleRows(first, rows) = other.filtered_unresolved.middleRows(first, rows);
  for (std::size_t row = range.begin; row < range.end; ++row) age[row] = other.age[row];
}

double settling_time(const ContactObserverOptions& options) {
  return kSettlingTimes / options.gain + kFilterSettlingTimes * options.filter_time;
}

Eigen::MatrixXd joint_velocities(const JointLog& log) {
  if (log.velocity.rows() == log.position.rows()) return log.velocity;
  Eigen::MatrixXd velocity = Eigen::MatrixXd::Zero(log.position.rows(), log.position.cols());
  for (std::size_t row = 1; row < log.t.size(); ++row) {
    const auto i = static_cast<Eigen::Index>(row);
    velocity.row(i) =
        (log.position.row(i) - log.position.row(i - 1)) / (log.t[row] - log.t[row - 1]);
  }
  return velocity;
}

ObservedRows observe_rows(const JointLog& log, const Eigen::MatrixXd& velocity, RowRange range,
                          ContactObserver observer, double sign,
                          const ContactObserverOptions& options) {
  ObservedRows observed(log.position.rows(), log.position.cols());
  const double max_interval = kGapIntervals * usual_interval(log.t);
  double started = log.t[range.begin];
  const auto first = static_cast<Eigen::Index>(range.begin);
  observer.reset(log.position.row(first).transpose(), velocity.row(first).transpose());
  for (std::size_t row = range.begin + 1; row < range.end; ++row) {
    const auto i = static_cast<Eigen::Index>(row);
    const double dt = log.t[row] - log.t[row - 1];
    const Eigen::VectorXd q = log.position.row(i).transpose(), dq = velocity.row(i).transpose();
    if (dt > max_interval) {
      observer.reset(q, dq);
      started = log.t[row];
      continue;
    }
    observed.external.row(i) =
        observer.update(q, dq, sign * log.torque.row(i).transpose(), dt).transpose();
    observed.unresolved.row(i) = observer.unresolved().transpose();
    observed.age[row] = log.t[row] - started;
    // Implicit, as the observer; a positive kernel keeps what is unresolved a bound.
    const double share = observed.is_settled(row, options) ? dt / (options.filter_time + dt) : 1.0;
    observed.filtered.row(i) =
        (1.0 - share) * observed.filtered.row(i - 1) + share * observed.external.row(i);
    observed.filtered_unresolved.row(i) = (1.0 - share) * observed.filtered_unresolved.row(i - 1) +
                                          share * observed.unresolved.row(i);
  }
  return observed;
}

}  // namespace pcavr
