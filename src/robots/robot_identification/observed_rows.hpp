// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "pcavr/recordings/recording/joint_log.hpp"
#include "pcavr/robots/robot_identification/contact_observer.hpp"

namespace pcavr {

/// Rows of a log.
struct RowRange {
  std::size_t begin = 0, end = 0;
};

/// The external torques [N m] of a log, row by row, and those behind a further low pass.
struct ObservedRows {
  Eigen::MatrixXd external, unresolved;
  Eigen::MatrixXd filtered, filtered_unresolved;
  std::vector<double> age;  ///< [s] since the observer started, at the log's start or behind a gap

  ObservedRows(Eigen::Index rows, Eigen::Index joints);
  [[nodiscard]] bool is_settled(std::size_t row, const ContactObserverOptions& options) const;
  [[nodiscard]] bool is_filter_settled(std::size_t row,
                                       const ContactObserverOptions& options) const;
  void take(const ObservedRows& other, RowRange range);
};

/// [rad/s] row by row: the log's velocities, else backward differences.
[[nodiscard]] Eigen::MatrixXd joint_velocities(const JointLog& log);

/// [s] until observer and filter have forgotten their start.
[[nodiscard]] double settling_time(const ContactObserverOptions& options);

/// Runs the observer over `range`; the other rows stay 0. `sign`: of the torques. Causal.
[[nodiscard]] ObservedRows observe_rows(const JointLog& log, const Eigen::MatrixXd& velocity,
                                        RowRange range, ContactObserver observer, double sign,
                                        const ContactObserverOptions& options);

}  // namespace pcavr
