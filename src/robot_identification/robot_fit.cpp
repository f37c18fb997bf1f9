// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robot_identification/robot_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "pcavr/core/check.hpp"
#include "pcavr/core/median.hpp"

#include "robot_identification/base_parameters.hpp"
#include "robot_identification/block_system.hpp"
#include "robot_identification/fit_rows.hpp"
#include "robot_identification/physical_fit.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kBlocks = 30;  ///< of the training part: cross-validation joins them to folds
constexpr std::size_t kFolds = 5;
constexpr double kPlainSmoothing = 0.05;  ///< [rad/s] of plain least squares, as published fits use
constexpr double kUnknownMass = 3.0;      ///< [kg] prior of a body without mass in the description
constexpr double kWide = 1e4;             ///< std that leaves a parameter to the data
/// Factors of the prior's std that cross-validation chooses from.
constexpr std::array<double, 6> kPriorScales{0.03, 0.1, 0.3, 1.0, 3.0, 10.0};
constexpr int kRobustRounds = 2;
/// Smallest over largest eigenvalue of a pseudo-inertia that counts as positive definite.
constexpr double kMinPhysicalMargin = 1e-7;

Eigen::Index at(std::size_t index) { return static_cast<Eigen::Index>(index); }

/// Everything that the steps of one fit share.
class Fit {
 public:
  Fit(const JointSignals& signals, const RobotModel& model, const RobotFitOptions& options)
      : signals_(signals),
        model_(model),
        options_(options),
        joints_(rigid_rows(signals, model)),
        rows_(signals.position.rows()) {
    train_ = static_cast<Eigen::Index>(options.train_share * static_cast<double>(rows_));
    smoothing_.assign(joints_.size(), kPlainSmoothing);
    prior_ = rigid_prior();
  }

  RobotFit run() {
    RobotFit fit;
    fit.joints.resize(joints_.size());
    fit_plainly(fit);
    remove_torque_lag(fit);
    choose_smoothing();
    fit_friction_terms();
    finish(fit);
    return fit;
  }

 private:
  [[nodiscard]] FitPrior rigid_prior() const;
  void set_libraries(const std::vector<LibraryColumn>& library);
  [[nodiscard]] BlockSystem train_system() const;
  void set_library_std(const BlockSystem& system);
  [[nodiscard]] Eigen::VectorXd residual(std::size_t joint, const FitSolution& solution) const;
  [[nodiscard]] Eigen::VectorXd cross_validate(const BlockSystem& system,
                                               const Selection& selection,
                                               const FitPrior& prior) const;
  void fit_plainly(RobotFit& fit);
  void remove_torque_lag(RobotFit& fit);
  void choose_smoothing();
  void set_variance();
  void fit_friction_terms();
  void update_noise(const FitSolution& solution, bool is_robust);
  void select_terms(const BlockSystem& system);
  [[nodiscard]] bool is_dissipative(const BlockSystem& system, const Selection& selection,
                                    std::size_t joint) const;
  void choose_prior_scale(const BlockSystem& system);
  void make_physical(const BlockSystem& system);
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
  std::vector<double> smoothing_;
  FitPrior prior_;
  double prior_scale_ = 1.0;
  Selection selection_;
  Eigen::VectorXd variance_;         ///< by joint, times the correlated rows
  Eigen::VectorXd noise_;            ///< std by joint
  Eigen::VectorXd correlated_rows_;  ///< by joint
  FitSolution solution_;
};

/// How many consecutive values count as one independent one: 1 + 2 sum of the autocorrelation up to
/// its first zero.
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

double robust_std(const Eigen::VectorXd& residual) {
  std::vector<double> sizes(static_cast<std::size_t>(residual.size()));
  for (Eigen::Index i = 0; i < residual.size(); ++i) {
    sizes[static_cast<std::size_t>(i)] = std::abs(residual[i]);
  }
  return 1.4826 * median(std::move(sizes));  // a normal's std over its median deviation
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

FitPrior Fit::rigid_prior() const {
  FitPrior prior;
  prior.mean = inertial_parameters(model_);
  prior.std.resize(prior.mean.size());
  const double reach = options_.prior_offset_std;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    auto mean = prior.mean.segment<10>(at(10 * j));
    if (mean[0] <= 0.0) {
      mean.setZero();
      mean[0] = kUnknownMass;
      mean[4] = mean[7] = mean[9] = kUnknownMass * reach * reach;
    }
    const double mass_std = options_.prior_mass_std;
    const double moment_std = (mean[0] + mass_std) * reach;
    auto std = prior.std.segment<10>(at(10 * j));
    std.setConstant(moment_std * reach + 0.3 * (mean[4] + mean[7] + mean[9]));
    std.segment<3>(1).setConstant(moment_std);
    std[0] = mass_std;
  }
  if (options_.known_body) prior.std.setConstant(1e-9);
  return prior;
}

FitPrior Fit::scaled_prior(double scale) const {
  FitPrior prior = prior_;
  if (!options_.known_body) prior.std *= scale;
  return prior;
}

void Fit::set_libraries(const std::vector<LibraryColumn>& library) {
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    LibraryInput input{signals_.position.col(at(j)),
                       signals_.velocity.col(at(j)),
                       signals_.acceleration.col(at(j)),
                       {},
                       smoothing_[j]};
    if (solution_.rigid.size() > 0) input.load = joints_[j].rigid * solution_.rigid;
    if (input.load.size() == 0) input.load.setZero(rows_);
    joints_[j].library = library_columns(library, input);
  }
}

BlockSystem Fit::train_system() const { return block_system(joints_, train_, kBlocks); }

/// A library parameter may produce up to ten times the joint's torque: left to the data.
void Fit::set_library_std(const BlockSystem& system) {
  prior_.library_std.clear();
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    NormalEquations sum;
    for (const auto& block : system.blocks) sum.add(block[j]);
    Eigen::VectorXd& std = prior_.library_std.emplace_back(system.library);
    for (Eigen::Index k = 0; k < system.library; ++k) {
      const double power = sum.gram(system.rigid + k, system.rigid + k);
      std[k] = power > 0.0 ? 10.0 * std::sqrt(sum.power / power) : 1.0;
    }
  }
}

Eigen::VectorXd Fit::residual(std::size_t joint, const FitSolution& solution) const {
  const JointRows& rows = joints_[joint];
  return rows.torque - rows.rigid * solution.rigid - rows.library * solution.library[joint];
}

/// Mean squared error by joint over folds of consecutive blocks that were left out.
Eigen::VectorXd Fit::cross_validate(const BlockSystem& system, const Selection& selection,
                                    const FitPrior& prior) const {
  Eigen::VectorXd error = Eigen::VectorXd::Zero(at(joints_.size())), count = error;
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    std::vector<bool> use(system.blocks.size());
    for (std::size_t b = 0; b < use.size(); ++b) use[b] = b * kFolds / use.size() != fold;
    const FitSolution solution = solve(system, use, selection, variance_, prior);
    for (std::size_t b = 0; b < use.size(); ++b) {
      if (use[b]) continue;
      for (std::size_t j = 0; j < joints_.size(); ++j) {
        error[at(j)] += system.blocks[b][j].squared_error(solution.of_joint(j));
        count[at(j)] += system.blocks[b][j].count;
      }
    }
  }
  return error.cwiseQuotient(count);
}

/// Ordinary least squares, as published identifications use it: the figure to beat.
void Fit::fit_plainly(RobotFit& fit) {
  set_libraries(full_library());
  const BlockSystem system = train_system();
  set_library_std(system);
  const Selection selection(joints_.size(), {column_of(full_library(), FrictionTerm::offset),
                                             column_of(full_library(), FrictionTerm::viscous),
                                             column_of(full_library(), FrictionTerm::coulomb)});
  FitPrior wide = prior_;
  if (!options_.known_body) wide.std.setConstant(kWide);
  const Eigen::VectorXd equal = Eigen::VectorXd::Constant(at(joints_.size()), 1e-2);
  solution_ = solve(system, std::vector<bool>(kBlocks, true), selection, equal, wide);
  noise_.resize(at(joints_.size()));
  correlated_rows_.setOnes(at(joints_.size()));
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const Eigen::VectorXd r = residual(j, solution_);
    fit.joints[j].plain_held_out = error_of(j, r, true);
    noise_[at(j)] = std::max(1e-9, std::sqrt(r.head(train_).squaredNorm() / double(train_)));
    correlated_rows_[at(j)] = correlated_rows(r.head(train_));
  }
  set_variance();
}

/// Torques that are late by L are tau(t - L), about tau - L dtau/dt: one further unknown that all
/// joints share.
void Fit::remove_torque_lag(RobotFit& fit) {
  constexpr double kLagPrior = 0.1;  // [s] std: wider than any lag that is looked for
  std::vector<JointRows> extended = joints_;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    Eigen::MatrixXd& rigid = extended[j].rigid;
    rigid.conservativeResize(Eigen::NoChange, rigid.cols() + 1);
    // Of the fitted bodies: the noise of the measured torques' rate would make the lag too small.
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
  // What friction's model does not reproduce at reversals looks like a small lag, too.
  if (std::abs(fit.torque_lag) < 3.0 * fit.torque_lag_std) {
    fit.torque_lag = 0.0;
    return;
  }
  for (std::size_t j = 0; j < joints_.size(); ++j) joints_[j].torque = extended[j].torque;
}

void Fit::choose_smoothing() {
  if (options_.smoothing_speed > 0.0) {
    smoothing_.assign(joints_.size(), options_.smoothing_speed);
    return;
  }
  const std::vector<LibraryColumn>& library = smoothing_library();
  set_libraries(library);
  const BlockSystem system = train_system();
  set_library_std(system);
  const std::vector<int> common{column_of(library, FrictionTerm::offset),
                                column_of(library, FrictionTerm::viscous)};
  std::vector<double> best(joints_.size(), std::numeric_limits<double>::max());
  for (std::size_t k = 0; k < kSmoothingSpeeds.size(); ++k) {
    Selection selection(joints_.size(), common);
    for (auto& columns : selection) {
      columns.push_back(column_of(library, FrictionTerm::coulomb, k));
    }
    const Eigen::VectorXd error = cross_validate(system, selection, prior_);
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      if (error[at(j)] >= best[j]) continue;
      best[j] = error[at(j)];
      smoothing_[j] = kSmoothingSpeeds[k];
    }
  }
}

/// Residual stds, their correlation, and robust weights [Huber 1964].
void Fit::update_noise(const FitSolution& solution, bool is_robust) {
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
void Fit::set_variance() {
  const double log_mean = correlated_rows_.array().log().mean();
  variance_ = std::exp(log_mean) * noise_.cwiseAbs2();
}

/// Adds the term that lowers a joint's cross-validated error the most, until none does by min_gain.
void Fit::select_terms(const BlockSystem& system) {
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
bool Fit::is_dissipative(const BlockSystem& system, const Selection& selection,
                         std::size_t joint) const {
  const FitSolution solution = solve(system, std::vector<bool>(kBlocks, true), selection, variance_,
                                     scaled_prior(prior_scale_));
  const Eigen::VectorXd& values = solution.library[joint];
  const auto value = [&](FrictionTerm term) { return values[column_of(full_library(), term)]; };
  return value(FrictionTerm::viscous) >= 0.0 && value(FrictionTerm::coulomb) >= 0.0 &&
         value(FrictionTerm::motor_inertia) >= 0.0;
}

void Fit::choose_prior_scale(const BlockSystem& system) {
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

void Fit::fit_friction_terms() {
  const std::vector<LibraryColumn>& library = full_library();
  const std::vector<bool> all(kBlocks, true);
  selection_.assign(joints_.size(), {column_of(library, FrictionTerm::offset),
                                     column_of(library, FrictionTerm::viscous),
                                     column_of(library, FrictionTerm::coulomb)});
  set_libraries(library);
  BlockSystem system = train_system();
  set_library_std(system);
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
  if (options_.is_physical && !options_.known_body) make_physical(system);
}

/// Moves the solution to the nearest possible bodies, in the metric of its own covariance.
void Fit::make_physical(const BlockSystem& system) {
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

TorqueError Fit::error_of(std::size_t joint, const Eigen::VectorXd& residuals,
                          bool is_held_out) const {
  const Eigen::Index first = is_held_out ? train_ : 0;
  const Eigen::Index count = is_held_out ? rows_ - train_ : train_;
  if (count == 0) return {};
  const double error = residuals.segment(first, count).squaredNorm();
  const double torque = joints_[joint].torque.segment(first, count).squaredNorm();
  return {std::sqrt(error / static_cast<double>(count)), std::sqrt(error / torque)};
}

void Fit::finish(RobotFit& fit) {
  const std::vector<LibraryColumn>& library = full_library();
  fit.train_rows = static_cast<std::size_t>(train_);
  fit.inertial_parameters = solution_.rigid;
  fit.fitted_torque.resize(rows_, at(joints_.size()));
  Eigen::Index place = solution_.rigid.size();
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    JointFit& joint = fit.joints[j];
    joint.name = model_.joints[j].name;
    joint.smoothing_speed = smoothing_[j];
    joint.noise_std = noise_[at(j)];
    joint.correlated_rows = correlated_rows_[at(j)];
    for (const int column : selection_[j]) {
      const LibraryColumn& entry = library[static_cast<std::size_t>(column)];
      const double std = std::sqrt(solution_.covariance(place, place));
      joint.friction.push_back(
          {entry.term, solution_.ordered[place], std, std < 0.3 * prior_.library_std[j][column]});
      if (entry.term == FrictionTerm::stribeck) {
        joint.stribeck_speed = kStribeckSpeeds[entry.candidate];
      }
      ++place;
    }
    const Eigen::VectorXd r = residual(j, solution_);
    joint.train = error_of(j, r, false);
    joint.held_out = error_of(j, r, true);
    fit.fitted_torque.col(at(j)) = joints_[j].torque - r;
  }
  fit.prior_scale = prior_scale_;
  fit.is_physical = true;
  for (Eigen::Index body = 0; body < at(joints_.size()); ++body) {
    fit.is_physical &= physical_margin(solution_.rigid.segment<10>(10 * body)) > 0.0;
  }
  fit.base_parameters = base_parameters(
      model_, solution_.rigid,
      solution_.covariance.topLeftCorner(solution_.rigid.size(), solution_.rigid.size()),
      scaled_prior(prior_scale_).std);
}

}  // namespace

RobotModel RobotFit::robot(const RobotModel& described) const {
  RobotModel model = with_inertial_parameters(described, inertial_parameters);
  for (std::size_t j = 0; j < joints.size(); ++j) {
    model.joints[j].armature = joints[j].value_of(FrictionTerm::motor_inertia);
  }
  return model;
}

RobotFit fit_robot(const JointSignals& signals, const RobotModel& model,
                   const RobotFitOptions& options) {
  return Fit(signals, model, options).run();
}

}  // namespace pcavr
