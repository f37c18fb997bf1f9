// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "pcavr/robots/robot/robot_model.hpp"
#include "pcavr/robots/robot_identification/joint_signals.hpp"

#include "robots/robot_identification/block_system.hpp"

namespace pcavr::detail {

/// Folds of consecutive rows, each left out of a fit in turn.
inline constexpr std::size_t kComparedFolds = 5;

/// Rows of the first `share` of the signals, equally spaced, that fits are compared on: 7 joints,
/// 80 unknowns.
[[nodiscard]] JointSignals thinned(const JointSignals& signals, double share = 1.0);

/// A plain fit in folds, to compare models of a log: bodies, and offset, viscous and Coulomb
/// friction. The prior is that of every fit: without one, the folds of short logs do not predict
/// each other.
struct FoldedFit {
  BlockSystem system;
  Selection selection;
  Eigen::VectorXd variance;
  FitPrior prior;

  /// `joints`: rigid rows of the signals; their torques become those of the signals.
  FoldedFit(const JointSignals& signals, const RobotModel& model, std::vector<JointRows> joints);

  [[nodiscard]] FitSolution solve_all(bool with_covariance = false) const;
  /// Log of the relative error of each joint in the fit of all rows.
  [[nodiscard]] Eigen::VectorXd fitted_misfit() const;
  /// Log of the relative error in the rows that are left out, by fold (row) and joint (column).
  [[nodiscard]] Eigen::MatrixXd left_out_misfit() const;
};

}  // namespace pcavr::detail
