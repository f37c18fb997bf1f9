// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Steps before the friction terms are fitted: the fit to compare with, the torques' lag, and the
// smoothing of signs.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "robots/robot_identification/robot_fitter.hpp"

namespace pcavr::detail {
namespace {

constexpr double kWide = 1e4;      ///< std that leaves a parameter to the data
constexpr double kLagPrior = 0.1;  ///< [s] std: wider than any lag that is looked for
/// Speed over a joint's rms speed below which it is about to reverse: a tenth of a sine's time on
/// either side.
constexpr double kSlow = 0.3;

/// The part of the joint's last column that its others and the rigid ones do not explain, in the
/// rows that count.
Eigen::VectorXd alone(const JointRows& rows, const std::vector<int>& columns) {
  const Eigen::Index rigid = rows.rigid.cols(), others = at(columns.size()) - 1;
  Eigen::MatrixXd rest(rows.rigid.rows(), rigid + others);
  rest.leftCols(rigid) = rows.rigid;
  for (Eigen::Index k = 0; k < others; ++k) {
    rest.col(rigid + k) = rows.library.col(columns[static_cast<std::size_t>(k)]);
  }
  rest.array().colwise() *= rows.weight.array();
  const Eigen::VectorXd last = rows.library.col(columns.back()).cwiseProduct(rows.weight);
  return last - rest * rest.completeOrthogonalDecomposition().solve(last);
}

/// Std of a coefficient of least squares from its column, less what the others explain, and the
/// residual: errors of different blocks are independent, those of one need not be [Liang & Zeger
/// 1986].
double coefficient_std(const Eigen::VectorXd& column, const Eigen::VectorXd& residual) {
  double squares = 0.0;
  for (std::size_t block = 0; block < kBlocks; ++block) {
    const Eigen::Index first = column.size() * at(block) / at(kBlocks);
    const Eigen::Index count = column.size() * at(block + 1) / at(kBlocks) - first;
    const double sum = column.segment(first, count).dot(residual.segment(first, count));
    squares += sum * sum;
  }
  return std::sqrt(squares) / column.squaredNorm();
}

}  // namespace

double correlated_rows(const Eigen::VectorXd& residual) {
  const double power = residual.squaredNorm();
  double sum = 1.0;
  for (Eigen::Index lag = 1; lag < residual.size() / 4; ++lag) {
    const Eigen::Index count = residual.size() - lag;
    const double correlation = residual.head(count).dot(residual.tail(count)) / power;
    if (!(correlation > 0.0)) break;
    sum += 2.0 * correlation;
  }
  return sum;
}

/// Ordinary least squares, as published identifications use it: the figure to beat.
void RobotFitter::fit_plainly(RobotFit& fit) {
  set_libraries(full_library());
  const BlockSystem system = train_system();
  set_library_std(system, full_library());
  const Selection selection(joints_.size(), {column_of(full_library(), FrictionTerm::offset),
                                             column_of(full_library(), FrictionTerm::viscous),
                                             column_of(full_library(), FrictionTerm::coulomb)});
  FitPrior wide = prior_;
  if (!options_.known_body) wide.std.setConstant(kWide);
  const Eigen::VectorXd equal = Eigen::VectorXd::Constant(at(joints_.size()), 1e-2);
  solution_ = solve(system, std::vector<bool>(kBlocks, true), selection, equal, wide);
  noise_.resize(at(joints_.size()));
  correlated_rows_.setOnes(at(joints_.size()));
  plain_coulomb_.resize(at(joints_.size()));
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    plain_coulomb_[at(j)] =
        std::abs(solution_.library[j][column_of(full_library(), FrictionTerm::coulomb)]);
    const Eigen::VectorXd r = residual(j, solution_);
    fit.joints[j].plain_held_out = error_of(j, r, true);
    noise_[at(j)] = std::max(1e-9, std::sqrt(r.head(train_).squaredNorm() / double(train_)));
    correlated_rows_[at(j)] = correlated_rows(r.head(train_));
  }
  set_variance();
}

/// Torques that are late by L are tau(t - L), about tau - L dtau/dt: one further unknown that all
/// joints share. An unusual lag is removed only where rows that were left out are predicted better
/// without it.
void RobotFitter::remove_torque_lag(RobotFit& fit) {
  std::vector<JointRows> extended = joints_;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    Eigen::MatrixXd& rigid = extended[j].rigid;
    rigid.conservativeResize(Eigen::NoChange, rigid.cols() + 1);
    // The rate is that of the fitted bodies' torques: the noise of the measured torques' rate would
    // make the lag too small.
    rigid.rightCols<1>() = -differentiate(joints_[j].rigid * solution_.rigid, signals_.interval);
  }
  const Selection selection(joints_.size(), {column_of(full_library(), FrictionTerm::offset),
                                             column_of(full_library(), FrictionTerm::viscous),
                                             column_of(full_library(), FrictionTerm::coulomb)});
  FitPrior prior = prior_;
  prior.mean.conservativeResize(prior.mean.size() + 1);
  prior.std.conservativeResize(prior.std.size() + 1);
  prior.mean.tail<1>().setZero();
  prior.std.tail<1>().setConstant(kLagPrior);
  // Each round moves the torques by what is left: friction changes its sign at the right instants
  // only once they are in step.
  constexpr int kRounds = 4;
  for (int round = 0; round < kRounds; ++round) {
    const FitSolution solution =
        solve(block_system(extended, train_, kBlocks), std::vector<bool>(kBlocks, true), selection,
              variance_, prior, true);
    const Eigen::Index place = solution.rigid.size() - 1;
    fit.torque_lag = std::clamp(fit.torque_lag + solution.rigid[place], -kLagPrior, kLagPrior);
    fit.torque_lag_std = std::sqrt(solution.covariance(place, place));
    std::vector<double> later = signals_.t;
    for (double& t : later) t += fit.torque_lag;
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      extended[j].torque = interpolate(signals_.t, signals_.torque.col(at(j)), later);
    }
  }
  // Errors of friction's model at reversals look like a small lag, too.
  const bool is_certain = std::abs(fit.torque_lag) >= 3.0 * fit.torque_lag_std;
  std::vector<JointRows> moved = joints_;
  for (std::size_t j = 0; j < joints_.size(); ++j) moved[j].torque = extended[j].torque;
  const auto left_out_error = [&](const std::vector<JointRows>& rows) {
    const BlockSystem system = block_system(rows, train_, kBlocks);
    return cross_validate(system, selection, prior_).array().log().sum();
  };
  const bool is_usual = std::abs(fit.torque_lag) <= options_.usual_torque_lag;
  if (is_certain && (is_usual || left_out_error(moved) < left_out_error(joints_))) {
    joints_ = std::move(moved);
  } else {
    fit.torque_lag = 0.0;
  }
}

/// The lag of each joint's torques after those of all: one further unknown of each joint, whose
/// column is its library's last. `columns`: of the library.
std::vector<EstimatedLag> RobotFitter::joint_lags(const std::vector<JointRows>& joints,
                                                  const std::vector<int>& columns) const {
  FitPrior prior = prior_;
  for (Eigen::VectorXd& std : prior.library_std) {
    std.conservativeResize(std.size() + 1);
    std.tail<1>().setConstant(kLagPrior);
  }
  const FitSolution solution =
      solve(block_system(joints, train_, kBlocks), std::vector<bool>(kBlocks, true),
            Selection(joints.size(), columns), variance_, prior);
  std::vector<EstimatedLag> lags;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const JointRows& rows = joints[j];
    const Eigen::VectorXd residual =
        rows.torque - rows.rigid * solution.rigid - rows.library * solution.library[j];
    lags.push_back({solution.library[j][columns.back()],
                    coefficient_std(alone(rows, columns).head(train_), residual.head(train_))});
  }
  return lags;
}

/// Friction after a reversal may look like a lag, and a lag of friction in proportion to the speed
/// is motor inertia's torque: the second estimate is of the rows between reversals, with that
/// inertia. Before the signs are chosen: friction that builds up by displacement would take up a
/// lag.
void RobotFitter::find_joint_lags(RobotFit& fit) const {
  const auto lag = static_cast<int>(full_library().size());  // its column
  std::vector<JointRows> extended = joints_;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const Eigen::VectorXd fitted =
        joints_[j].rigid * solution_.rigid + joints_[j].library * solution_.library[j];
    Eigen::MatrixXd& library = extended[j].library;
    library.conservativeResize(Eigen::NoChange, lag + 1);
    library.rightCols<1>() = -differentiate(fitted, signals_.interval);
  }
  std::vector<int> columns{column_of(full_library(), FrictionTerm::offset),
                           column_of(full_library(), FrictionTerm::viscous),
                           column_of(full_library(), FrictionTerm::coulomb), lag};
  const std::vector<EstimatedLag> lags = joint_lags(extended, columns);
  columns.insert(columns.end() - 1, column_of(full_library(), FrictionTerm::motor_inertia));
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const Eigen::ArrayXd speed = signals_.velocity.col(at(j)).array().abs();
    const double slow = kSlow * std::sqrt(speed.square().mean());
    extended[j].weight = (speed >= slow).cast<double>().matrix();
  }
  const std::vector<EstimatedLag> sliding = joint_lags(extended, columns);
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    fit.joints[j].torque_lag = lags[j];
    fit.joints[j].sliding_lag = sliding[j];
  }
}

/// Chooses by cross-validation. Friction that builds up by displacement is chosen where it lowers
/// the error of the best smoothing speed by min_gain. Motor inertia is fitted as well: without it,
/// its torque at reversals is taken for a sign that changes late or early. First all joints try the
/// same candidate, then each joint beside the others' choices: a wrong sign of one joint moves the
/// bodies that all share.
void RobotFitter::choose_signs() {
  if (options_.smoothing_speed > 0.0) {
    signs_.assign(joints_.size(), {.smoothing_speed = options_.smoothing_speed});
    return;
  }
  const std::vector<LibraryColumn>& library = sign_library();
  set_libraries(library);
  const BlockSystem system = train_system();
  set_library_std(system, library);
  const std::vector<int> common{column_of(library, FrictionTerm::offset),
                                column_of(library, FrictionTerm::viscous),
                                column_of(library, FrictionTerm::motor_inertia)};
  const std::size_t count = joints_.size();
  const auto selection_of = [&](const std::vector<std::size_t>& candidates) {
    Selection selection(count, common);
    for (std::size_t j = 0; j < count; ++j) {
      selection[j].push_back(column_of(library, FrictionTerm::coulomb, candidates[j]));
    }
    return selection;
  };
  std::vector<std::vector<double>> errors(count);  // by joint and candidate
  for (std::size_t k = 0; k < sign_models().size(); ++k) {
    const Eigen::VectorXd error =
        cross_validate(system, selection_of(std::vector<std::size_t>(count, k)), prior_);
    for (std::size_t j = 0; j < count; ++j) errors[j].push_back(error[at(j)]);
  }
  std::vector<std::size_t> chosen(count);
  for (std::size_t j = 0; j < count; ++j) chosen[j] = choose_sign(j, errors[j]);
  for (std::size_t j = 0; j < count; ++j) {
    std::vector<std::size_t> tried = chosen;
    for (std::size_t k = 0; k < sign_models().size(); ++k) {
      tried[j] = k;
      errors[j][k] = cross_validate(system, selection_of(tried), prior_)[at(j)];
    }
    chosen[j] = choose_sign(j, errors[j]);
  }
}

/// Sets the sign of a joint by the squared errors of the candidates, and returns which it is.
std::size_t RobotFitter::choose_sign(std::size_t joint, const std::vector<double>& errors) {
  const auto speeds = errors.begin() + at(kSmoothingSpeeds.size());
  const auto by_speed = std::min_element(errors.begin(), speeds);
  const auto by_displacement = std::min_element(speeds, errors.end());
  const double share = 1.0 - options_.min_gain;
  const bool is_presliding = *by_displacement < share * share * *by_speed;
  // With a displacement, the best speed stays, for uses that keep no state.
  signs_[joint] = sign_models()[static_cast<std::size_t>(by_speed - errors.begin())];
  const auto best =
      static_cast<std::size_t>((is_presliding ? by_displacement : by_speed) - errors.begin());
  signs_[joint].presliding_displacement = sign_models()[best].presliding_displacement;
  return best;
}

}  // namespace pcavr::detail
