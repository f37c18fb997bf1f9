// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/stamp.hpp"
#include "pcavr/recordings/recording/time_series.hpp"

namespace pcavr {

/// The log of an arm: one row a sample, one column a joint. A matrix without rows: not recorded.
struct JointLog {
  std::vector<std::string> joints;  ///< what follows `q_` in the header: names, or numbers
  std::vector<Stamp> stamps;        ///< strictly ascending
  std::vector<double> t;            ///< [s] from the first row
  std::vector<int> lines;           ///< 1-based line of the file, row by row
  Eigen::MatrixXd position;         ///< [rad]
  Eigen::MatrixXd velocity;         ///< [rad/s]
  Eigen::MatrixXd torque;           ///< [N m]
  Eigen::MatrixXd current;          ///< [A]
  std::vector<std::string> unused;  ///< columns that are none of these
};

/// Reads `joints.csv`: columns in any order, by name: `t`, and for each joint NAME `q_NAME`, and
/// where recorded `dq_NAME`, `tau_NAME`, `current_NAME`. NAME is the joint's name in the URDF or
/// its number in the chain; `q1` is `q_1`. A quantity is recorded for all joints or for none.
/// `tau_ext_NAME` and other columns are listed in `unused`. Pure function.
[[nodiscard]] Expected<Series<JointLog>> parse_joint_log(const SeriesText& text);

/// The text of a `joints.csv`, from which parse_joint_log reads the same values.
[[nodiscard]] std::string format_joint_log(const JointLog& log);

}  // namespace pcavr
