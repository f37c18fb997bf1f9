// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "robots/robot_identification/folded_fit.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "robots/robot_identification/fit_rows.hpp"
#include "robots/robot_identification/robot_fitter.hpp"

namespace pcavr::detail {
namespace {

constexpr Eigen::Index kComparedRows = 400;  ///< of the log

double log_error(const NormalEquations& equations, const Eigen::VectorXd& parameters) {
  const double floor = 1e-8 * equations.power + 1e-12;
  return 0.5 * std::log((equations.squared_error(parameters) + floor) / (equations.power + floor));
}

}  // namespace

JointSignals thinned(const JointSignals& signals, double share) {
  JointSignals few = signals;
  const auto rows = static_cast<Eigen::Index>(share * static_cast<double>(signals.position.rows()));
  const Eigen::Index count = std::min(rows, kComparedRows);
  const auto thin = [&](Eigen::MatrixXd& values) {
    for (Eigen::Index i = 0; i < count; ++i) values.row(i) = values.row(i * rows / count).eval();
    values.conservativeResize(count, Eigen::NoChange);
  };
  for (Eigen::MatrixXd JointSignals::*values :
       {&JointSignals::position, &JointSignals::velocity, &JointSignals::acceleration,
        &JointSignals::torque, &JointSignals::torque_rate}) {
    thin(few.*values);
  }
  for (Eigen::MatrixXd& sign : few.smoothed_sign) thin(sign);
  for (Eigen::MatrixXd& sign : few.presliding_sign) thin(sign);
  return few;
}

FoldedFit::FoldedFit(const JointSignals& signals, const RobotModel& model,
                     std::vector<JointRows> joints)
    : variance(static_cast<Eigen::Index>(joints.size())), prior(rigid_prior(model, {})) {
  const std::vector<LibraryColumn>& library = full_library();
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(signals.position.rows());
  for (Eigen::Index j = 0; j < variance.size(); ++j) {
    JointRows& joint = joints[static_cast<std::size_t>(j)];
    joint.torque = signals.torque.col(j);
    joint.library = library_columns(
        library,
        {signals, static_cast<std::size_t>(j), none, {.smoothing_speed = kPlainSmoothing}});
    const double power = joint.torque.squaredNorm() / static_cast<double>(joint.torque.size());
    variance[j] = std::max(1e-6, 0.01 * power);
    prior.library_std.emplace_back(Eigen::VectorXd::Constant(joint.library.cols(), 1e3));
  }
  system = block_system(joints, signals.position.rows(), kComparedFolds);
  selection.assign(joints.size(), {column_of(library, FrictionTerm::offset),
                                   column_of(library, FrictionTerm::viscous),
                                   column_of(library, FrictionTerm::coulomb)});
}

FitSolution FoldedFit::solve_all(bool with_covariance) const {
  return solve(system, std::vector<bool>(kComparedFolds, true), selection, variance, prior,
               with_covariance);
}

Eigen::VectorXd FoldedFit::fitted_misfit() const {
  const FitSolution solution = solve_all();
  Eigen::VectorXd logs(variance.size());
  for (std::size_t j = 0; j < selection.size(); ++j) {
    NormalEquations equations;
    for (const auto& block : system.blocks) equations.add(block[j]);
    logs[at(j)] = log_error(equations, solution.of_joint(j));
  }
  return logs;
}

Eigen::MatrixXd FoldedFit::left_out_misfit() const {
  Eigen::MatrixXd logs(at(kComparedFolds), variance.size());
  for (std::size_t fold = 0; fold < kComparedFolds; ++fold) {
    std::vector<bool> is_fitted(kComparedFolds, true);
    is_fitted[fold] = false;
    const FitSolution solution = solve(system, is_fitted, selection, variance, prior);
    for (std::size_t j = 0; j < selection.size(); ++j) {
      logs(at(fold), at(j)) = log_error(system.blocks[fold][j], solution.of_joint(j));
    }
  }
  return logs;
}

}  // namespace pcavr::detail
