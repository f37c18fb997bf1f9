// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "pcavr/robots/robot_identification/robot_fit.hpp"

#include "robots/robot_identification/block_system.hpp"
#include "robots/robot_identification/fit_rows.hpp"

namespace pcavr::detail {

inline constexpr std::size_t kBlocks = 30;  ///< of the training part: cross-validation joins them

/// Number of stretches of the training part, left out in turn for the stds.
inline constexpr std::size_t kStretches = 10;

[[nodiscard]] inline Eigen::Index at(std::size_t index) { return static_cast<Eigen::Index>(index); }

/// The number of consecutive values that count as one independent one: 1 + 2 sum of the
/// autocorrelation up to its first zero.
[[nodiscard]] double correlated_rows(const Eigen::VectorXd& residual);

/// A prior about the described bodies, or about bodies of 3 kg where the description has no masses.
[[nodiscard]] FitPrior rigid_prior(const RobotModel& model, const RobotFitOptions& options);

/// Everything that the steps of one fit share.
class RobotFitter {
 public:
  RobotFitter(const JointSignals& signals, const RobotModel& model, const RobotFitOptions& options);

  [[nodiscard]] RobotFit run();

 private:
  void set_libraries(const std::vector<LibraryColumn>& library);
  [[nodiscard]] BlockSystem train_system() const;
  void set_library_std(const BlockSystem& system, const std::vector<LibraryColumn>& library);
  [[nodiscard]] Eigen::VectorXd residual(std::size_t joint, const FitSolution& solution) const;
  [[nodiscard]] Eigen::VectorXd cross_validate(const BlockSystem& system,
                                               const Selection& selection,
                                               const FitPrior& prior) const;
  void fit_plainly(RobotFit& fit);
  void remove_torque_lag(RobotFit& fit);
  [[nodiscard]] std::vector<EstimatedLag> joint_lags(const std::vector<JointRows>& joints,
                                                     const std::vector<int>& columns) const;
  void find_joint_lags(RobotFit& fit) const;
  void choose_signs();
  std::size_t choose_sign(std::size_t joint, const std::vector<double>& errors);
  void set_variance();
  void fit_friction_terms();
  void update_noise(const FitSolution& solution, bool is_robust);
  void select_terms(const BlockSystem& system);
  [[nodiscard]] bool is_dissipative(const BlockSystem& system, const Selection& selection,
                                    std::size_t joint) const;
  void choose_prior_scale(const BlockSystem& system);
  void make_physical(const BlockSystem& system);
  void set_friction(const FitSolution& solution, std::size_t index, JointFit& joint) const;
  void set_equivalent(std::size_t index, Eigen::Index first, JointFit& joint) const;
  void set_covariance(const BlockSystem& system);
  void leave_out(const BlockSystem& system);
  void finish(RobotFit& fit);
  [[nodiscard]] FitPrior scaled_prior(double scale) const;
  [[nodiscard]] TorqueError error_of(std::size_t joint, const Eigen::VectorXd& residuals,
                                     bool is_held_out) const;

  const JointSignals& signals_;
  const RobotModel& model_;
  const RobotFitOptions& options_;
  std::vector<JointRows> joints_;
  Eigen::Index rows_;
  Eigen::Index train_ = 0;
  std::vector<SignModel> signs_;   ///< by joint
  Eigen::VectorXd plain_coulomb_;  ///< [N m] by joint, of plain least squares
  FitPrior prior_;
  double prior_scale_ = 1.0;
  Selection selection_;
  Eigen::VectorXd variance_;         ///< by joint, times the correlated rows
  Eigen::VectorXd noise_;            ///< std by joint
  Eigen::VectorXd correlated_rows_;  ///< by joint
  FitSolution solution_;
  Eigen::MatrixXd prior_covariance_;  ///< of the solution: what the prior's errors make of it
  Eigen::MatrixXd changes_;           ///< of the solution by leaving out a stretch each
  std::vector<LeftOutFit> left_out_;
};

}  // namespace pcavr::detail
