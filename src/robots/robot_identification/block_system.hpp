// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace pcavr {

/// The rows of one joint: torque = [rigid, library] * parameters. `rigid` columns are shared by all
/// joints, `library` ones are this joint's own.
struct JointRows {
  Eigen::MatrixXd rigid;
  Eigen::MatrixXd library;
  Eigen::VectorXd torque;
  Eigen::VectorXd weight;  ///< of each row, 0 to 1 (robust)
};

/// Normal equations of one joint's rows within one block of time.
struct NormalEquations {
  Eigen::MatrixXd gram;
  Eigen::VectorXd moment;
  double power = 0.0;  ///< sum of squared torques
  double count = 0.0;  ///< sum of weights

  void add(const NormalEquations& other);
  /// Sum of squared residuals.
  [[nodiscard]] double squared_error(const Eigen::VectorXd& parameters) const;
};

/// Normal equations by block of time and joint: sums over any set of blocks cost nothing more, so
/// that cross-validation does not touch the rows again.
struct BlockSystem {
  Eigen::Index rigid = 0;                            ///< shared columns
  Eigen::Index library = 0;                          ///< columns of each joint
  std::vector<std::vector<NormalEquations>> blocks;  ///< [block][joint]
};

/// Splits `rows` rows into `blocks` blocks of equal length.
[[nodiscard]] BlockSystem block_system(const std::vector<JointRows>& joints, Eigen::Index rows,
                                       std::size_t blocks);

/// The library columns that each joint uses.
using Selection = std::vector<std::vector<int>>;

/// A Gaussian prior on the rigid columns, and standard deviations of the library's.
struct FitPrior {
  Eigen::VectorXd mean;
  Eigen::VectorXd std;
  std::vector<Eigen::VectorXd> library_std;  ///< by joint
};

struct FitSolution {
  Eigen::VectorXd rigid;
  std::vector<Eigen::VectorXd> library;  ///< by joint, all columns; 0 where not selected
  Eigen::MatrixXd covariance;            ///< of `ordered`
  Eigen::MatrixXd information;           ///< its inverse
  Eigen::VectorXd ordered;               ///< rigid, then the selected columns joint by joint

  /// Parameters of one joint's rows: rigid and library.
  [[nodiscard]] Eigen::VectorXd of_joint(std::size_t joint) const;
};

/// Least squares over the blocks where `use` is true; noise variance by joint.
[[nodiscard]] FitSolution solve(const BlockSystem& system, const std::vector<bool>& use,
                                const Selection& selection, const Eigen::VectorXd& variance,
                                const FitPrior& prior, bool with_covariance = false);

/// Changes of `solution` (without bounds) when a stretch of the blocks is left out, one column
/// each; `stretches`: as many of equal length.
[[nodiscard]] Eigen::MatrixXd leave_out_changes(const BlockSystem& system,
                                                const Selection& selection,
                                                const Eigen::VectorXd& variance,
                                                const FitPrior& prior, const FitSolution& solution,
                                                std::size_t stretches);

/// Covariance of values whose changes by leaving out are the columns: the jackknife's.
/// [Efron & Stein 1981]
[[nodiscard]] Eigen::MatrixXd jackknife_covariance(const Eigen::MatrixXd& changes);

/// Replaces the values of a solution; covariance and information stay.
void set_ordered(Eigen::VectorXd ordered, const BlockSystem& system, const Selection& selection,
                 FitSolution& solution);

}  // namespace pcavr
