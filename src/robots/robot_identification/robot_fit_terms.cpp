// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// The friction terms of each joint, the noise, and bodies that can exist.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "pcavr/base/core/median.hpp"

#include "robots/robot_identification/physical_fit.hpp"
#include "robots/robot_identification/robot_fitter.hpp"

namespace pcavr::detail {
namespace {

/// Factors of the prior's std that cross-validation chooses from.
constexpr std::array<double, 6> kPriorScales{0.03, 0.1, 0.3, 1.0, 3.0, 10.0};
constexpr int kRobustRounds = 2;
/// Smallest over largest eigenvalue of a pseudo-inertia that counts as positive definite.
constexpr double kMinPhysicalMargin = 1e-7;

double robust_std(const Eigen::VectorXd& residual) {
  std::vector<double> sizes(static_cast<std::size_t>(residual.size()));
  for (Eigen::Index i = 0; i < residual.size(); ++i) {
    sizes[static_cast<std::size_t>(i)] = std::abs(residual[i]);
  }
  return kStdOverMad * median(std::move(sizes));
}

/// The body itself, or where none can have these parameters a sphere of its mass.
Eigen::Matrix<double, 10, 1> possible_body(const Eigen::Matrix<double, 10, 1>& parameters) {
  constexpr double kRadiusOfGyration = 0.1;  // [m]
  if (physical_margin(parameters) > kMinPhysicalMargin) return parameters;
  Eigen::Matrix<double, 10, 1> sphere = Eigen::Matrix<double, 10, 1>::Zero();
  sphere[0] = std::max(parameters[0], 0.1);
  sphere[4] = sphere[7] = sphere[9] = sphere[0] * kRadiusOfGyration * kRadiusOfGyration;
  return sphere;
}

}  // namespace

/// Residual stds, their correlation, and robust weights [Huber 1964].
void RobotFitter::update_noise(const FitSolution& solution, bool is_robust) {
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const Eigen::VectorXd r = residual(j, solution);
    const Eigen::VectorXd train = r.head(train_);
    noise_[at(j)] = std::max(1e-9, std::sqrt(train.squaredNorm() / double(train_)));
    correlated_rows_[at(j)] = correlated_rows(train);
    if (!is_robust) continue;
    const double limit = options_.huber_threshold * std::max(1e-9, robust_std(train));
    for (Eigen::Index i = 0; i < rows_; ++i) {
      joints_[j].weight[i] = std::min(1.0, limit / std::max(limit, std::abs(r[i])));
    }
  }
  set_variance();
}

/// One correlation for all joints: a joint whose residual drifts must not lose its weight.
void RobotFitter::set_variance() {
  const double log_mean = correlated_rows_.array().log().mean();
  variance_ = std::exp(log_mean) * noise_.cwiseAbs2();
}

/// Adds the term that lowers a joint's cross-validated error the most, until none does by min_gain.
void RobotFitter::select_terms(const BlockSystem& system) {
  const std::vector<LibraryColumn>& library = full_library();
  const FitPrior prior = scaled_prior(prior_scale_);
  Eigen::VectorXd error = cross_validate(system, selection_, prior);
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    for (bool is_added = true; is_added;) {
      is_added = false;
      double best_score = std::log1p(-options_.min_gain);
      Selection best;
      for (int column = 0; column < static_cast<int>(library.size()); ++column) {
        const auto& used = selection_[j];
        const bool is_used = std::any_of(used.begin(), used.end(), [&](int k) {
          return library[static_cast<std::size_t>(k)].term ==
                 library[static_cast<std::size_t>(column)].term;
        });
        const bool is_basic =
            library[static_cast<std::size_t>(column)].term == FrictionTerm::motor_inertia;
        if (is_used || !(is_basic || options_.is_extended)) continue;
        Selection tried = selection_;
        tried[j].push_back(column);
        const Eigen::VectorXd tried_error = cross_validate(system, tried, prior);
        const double score = 0.5 * (tried_error.array() / error.array()).log().sum();
        if (score >= best_score || !is_dissipative(system, tried, j)) continue;
        best_score = score;
        best = std::move(tried);
      }
      if (best.empty()) break;
      selection_ = std::move(best);
      error = cross_validate(system, selection_, prior);
      is_added = true;
    }
  }
}

/// Whether viscous and Coulomb friction and motor inertia are positive with these terms:
/// combinations of opposite signs fit one log, and no other.
bool RobotFitter::is_dissipative(const BlockSystem& system, const Selection& selection,
                                 std::size_t joint) const {
  const FitSolution solution = solve(system, std::vector<bool>(kBlocks, true), selection, variance_,
                                     scaled_prior(prior_scale_));
  const Eigen::VectorXd& values = solution.library[joint];
  const auto value = [&](FrictionTerm term) { return values[column_of(full_library(), term)]; };
  return value(FrictionTerm::viscous) >= 0.0 && value(FrictionTerm::coulomb) >= 0.0 &&
         value(FrictionTerm::motor_inertia) >= 0.0;
}

void RobotFitter::choose_prior_scale(const BlockSystem& system) {
  if (options_.known_body) return;
  double best = std::numeric_limits<double>::max();
  for (const double scale : kPriorScales) {
    const Eigen::VectorXd error = cross_validate(system, selection_, scaled_prior(scale));
    const double score = error.array().log().sum();
    if (score >= best) continue;
    best = score;
    prior_scale_ = scale;
  }
}

void RobotFitter::fit_friction_terms() {
  const std::vector<LibraryColumn>& library = full_library();
  const std::vector<bool> all(kBlocks, true);
  selection_.assign(joints_.size(), {column_of(library, FrictionTerm::offset),
                                     column_of(library, FrictionTerm::viscous),
                                     column_of(library, FrictionTerm::coulomb)});
  set_libraries(library);
  BlockSystem system = train_system();
  set_library_std(system, library);
  choose_prior_scale(system);
  solution_ = solve(system, all, selection_, variance_, scaled_prior(prior_scale_));
  update_noise(solution_, true);
  set_libraries(library);
  system = train_system();
  select_terms(system);
  choose_prior_scale(system);
  for (int round = 0; round < kRobustRounds; ++round) {
    solution_ = solve(system, all, selection_, variance_, scaled_prior(prior_scale_));
    update_noise(solution_, true);
    system = train_system();
  }
  solution_ = solve(system, all, selection_, variance_, scaled_prior(prior_scale_), true);
  set_covariance(system);
  leave_out(system);
  if (options_.is_physical && !options_.known_body) make_physical(system);
}

/// Finds the covariance by leaving out stretches: residuals are errors of the model more than
/// noise, so that neither their size nor their correlation says how far they move the parameters.
void RobotFitter::set_covariance(const BlockSystem& system) {
  const FitPrior prior = scaled_prior(prior_scale_);
  changes_ = leave_out_changes(system, selection_, variance_, prior, solution_, kStretches);
  Eigen::VectorXd prior_std(solution_.ordered.size());
  prior_std.head(prior.std.size()) = prior.std;
  Eigen::Index place = prior.std.size();
  for (std::size_t j = 0; j < selection_.size(); ++j) {
    for (const int column : selection_[j]) prior_std[place++] = prior.library_std[j][column];
  }
  const Eigen::MatrixXd share = solution_.covariance * prior_std.cwiseInverse().asDiagonal();
  prior_covariance_ = share * share.transpose();
  solution_.covariance = prior_covariance_ + jackknife_covariance(changes_);
}

/// Moves the solution to the nearest possible bodies, in the metric of its own covariance.
void RobotFitter::make_physical(const BlockSystem& system) {
  const Eigen::Index bodies = at(joints_.size());
  bool is_possible = true;
  for (Eigen::Index body = 0; body < bodies; ++body) {
    is_possible &= physical_margin(solution_.rigid.segment<10>(10 * body)) > kMinPhysicalMargin;
  }
  if (is_possible) return;
  Eigen::VectorXd start = solution_.ordered;
  for (Eigen::Index body = 0; body < bodies; ++body) {
    start.segment<10>(10 * body) = possible_body(prior_.mean.segment<10>(10 * body));
  }
  set_ordered(fit_physical(solution_.ordered, solution_.information, start, bodies), system,
              selection_, solution_);
}

}  // namespace pcavr::detail
