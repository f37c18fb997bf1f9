// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot_identification/robot_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "pcavr/base/core/solvers.hpp"

#include "robots/robot_identification/base_parameters.hpp"
#include "robots/robot_identification/physical_fit.hpp"
#include "robots/robot_identification/robot_fitter.hpp"

namespace pcavr {
namespace detail {
namespace {

constexpr std::size_t kFolds = 5;
constexpr double kUnknownMass = 3.0;  ///< [kg] prior of a body without mass in the description

std::vector<bool> without_fold(const BlockSystem& system, std::size_t fold) {
  std::vector<bool> use(system.blocks.size());
  for (std::size_t b = 0; b < use.size(); ++b) use[b] = b * kFolds / use.size() != fold;
  return use;
}

}  // namespace

FitPrior rigid_prior(const RobotModel& model, const RobotFitOptions& options) {
  FitPrior prior;
  prior.mean = inertial_parameters(model);
  prior.std.resize(prior.mean.size());
  const double reach = options.prior_offset_std;
  for (std::size_t j = 0; j < model.dof; ++j) {
    auto mean = prior.mean.segment<10>(at(10 * j));
    if (mean[0] <= 0.0) {
      mean.setZero();
      mean[0] = kUnknownMass;
      mean[4] = mean[7] = mean[9] = kUnknownMass * reach * reach;
    }
    const double mass_std = options.prior_mass_std;
    const double moment_std = (mean[0] + mass_std) * reach;
    auto std = prior.std.segment<10>(at(10 * j));
    std.setConstant(moment_std * reach + 0.3 * (mean[4] + mean[7] + mean[9]));
    std.segment<3>(1).setConstant(moment_std);
    std[0] = mass_std;
  }
  if (options.known_body) prior.std.setConstant(1e-9);
  return prior;
}

RobotFitter::RobotFitter(const JointSignals& signals, const RobotModel& model,
                         const RobotFitOptions& options)
    : signals_(signals),
      model_(model),
      options_(options),
      joints_(rigid_rows(signals, model)),
      rows_(signals.position.rows()) {
  train_ = static_cast<Eigen::Index>(options.train_share * static_cast<double>(rows_));
  signs_.assign(joints_.size(), {.smoothing_speed = kPlainSmoothing});
  prior_ = rigid_prior(model, options);
}

RobotFit RobotFitter::run() {
  RobotFit fit;
  fit.joints.resize(joints_.size());
  fit_plainly(fit);
  remove_torque_lag(fit);
  find_joint_lags(fit);
  choose_signs();
  fit_friction_terms();
  finish(fit);
  return fit;
}

FitPrior RobotFitter::scaled_prior(double scale) const {
  FitPrior prior = prior_;
  if (!options_.known_body) prior.std *= scale;
  return prior;
}

void RobotFitter::set_libraries(const std::vector<LibraryColumn>& library) {
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    LibraryInput input{signals_, j, {}, signs_[j]};
    if (solution_.rigid.size() > 0) input.load = joints_[j].rigid * solution_.rigid;
    if (input.load.size() == 0) input.load.setZero(rows_);
    joints_[j].library = library_columns(library, input);
  }
}

BlockSystem RobotFitter::train_system() const { return block_system(joints_, train_, kBlocks); }

/// A library parameter may produce up to ten times the joint's torque: left to the data. A ripple
/// of the friction is as large as that: a larger one is an error of the bodies in the fitted
/// postures, which sin q, cos q and the offset together would continue to others.
void RobotFitter::set_library_std(const BlockSystem& system,
                                  const std::vector<LibraryColumn>& library) {
  prior_.library_std.clear();
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    NormalEquations sum;
    for (const auto& block : system.blocks) sum.add(block[j]);
    Eigen::VectorXd& std = prior_.library_std.emplace_back(system.library);
    for (Eigen::Index k = 0; k < system.library; ++k) {
      const double power = sum.gram(system.rigid + k, system.rigid + k);
      std[k] = power > 0.0 ? 10.0 * std::sqrt(sum.power / power) : 1.0;
      const FrictionTerm term = library[static_cast<std::size_t>(k)].term;
      const bool is_ripple = term == FrictionTerm::ripple_sin || term == FrictionTerm::ripple_cos;
      if (is_ripple && plain_coulomb_.size() > 0) std[k] = std::max(1e-9, plain_coulomb_[at(j)]);
    }
  }
}

Eigen::VectorXd RobotFitter::residual(std::size_t joint, const FitSolution& solution) const {
  const JointRows& rows = joints_[joint];
  return rows.torque - rows.rigid * solution.rigid - rows.library * solution.library[joint];
}

/// Mean squared error by joint over folds of consecutive blocks that were left out.
Eigen::VectorXd RobotFitter::cross_validate(const BlockSystem& system, const Selection& selection,
                                            const FitPrior& prior) const {
  Eigen::VectorXd error = Eigen::VectorXd::Zero(at(joints_.size())), count = error;
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    const std::vector<bool> use = without_fold(system, fold);
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

TorqueError RobotFitter::error_of(std::size_t joint, const Eigen::VectorXd& residuals,
                                  bool is_held_out) const {
  const Eigen::Index first = is_held_out ? train_ : 0;
  const Eigen::Index count = is_held_out ? rows_ - train_ : train_;
  if (count == 0) return {};
  const double error = residuals.segment(first, count).squaredNorm();
  const double torque = joints_[joint].torque.segment(first, count).squaredNorm();
  return {std::sqrt(error / static_cast<double>(count)), std::sqrt(error / torque)};
}

/// The terms of friction that are used, without stds.
void RobotFitter::set_friction(const FitSolution& solution, std::size_t index,
                               JointFit& joint) const {
  joint.sign = signs_[index];
  for (const int column : selection_[index]) {
    const LibraryColumn& entry = full_library()[static_cast<std::size_t>(column)];
    joint.friction.push_back({entry.term, solution.library[index][column]});
    if (entry.term == FrictionTerm::stribeck) {
      joint.stribeck_speed = kStribeckSpeeds[entry.candidate];
    }
  }
}

/// Projects the friction that is fitted onto offset, viscous and Coulomb friction. The std: of
/// terms and motion, both without a stretch each. `first`: place of the joint's terms in the
/// solution.
void RobotFitter::set_equivalent(std::size_t index, Eigen::Index first, JointFit& joint) const {
  constexpr std::array<FrictionTerm, 3> kTerms{FrictionTerm::offset, FrictionTerm::viscous,
                                               FrictionTerm::coulomb};
  const Eigen::VectorXd speed = signals_.velocity.col(at(index)).head(train_);
  Eigen::MatrixXd plain(train_, kTerms.size());
  plain << Eigen::VectorXd::Ones(train_), speed, speed.cwiseSign();
  Eigen::MatrixXd used(train_, at(joint.friction.size()));
  Eigen::VectorXd values(used.cols());
  for (Eigen::Index k = 0; k < used.cols(); ++k) {
    const FittedTerm& term = joint.friction[static_cast<std::size_t>(k)];
    values[k] = term.value;
    used.col(k) =
        joints_[index].library.col(selection_[index][static_cast<std::size_t>(k)]).head(train_);
    if (term.term == FrictionTerm::motor_inertia) used.col(k).setZero();
  }
  const Eigen::MatrixXd gram = plain.transpose() * plain, cross = plain.transpose() * used;
  const Eigen::MatrixXd projection = gram.ldlt().solve(cross);
  const Eigen::VectorXd found = projection * values;
  Eigen::MatrixXd changes(at(kTerms.size()), changes_.cols());
  for (Eigen::Index k = 0; k < changes.cols(); ++k) {
    const Eigen::Index begin = train_ * k / changes.cols();
    const Eigen::Index count = train_ * (k + 1) / changes.cols() - begin;
    const auto left_out = plain.middleRows(begin, count).transpose();
    changes.col(k) = (gram - left_out * plain.middleRows(begin, count))
                         .ldlt()
                         .solve((cross - left_out * used.middleRows(begin, count)) *
                                (values + changes_.col(k).segment(first, values.size()))) -
                     found;
  }
  const Eigen::MatrixXd spread =
      projection * prior_covariance_.block(first, first, values.size(), values.size()) *
          projection.transpose() +
      jackknife_covariance(changes);
  for (std::size_t k = 0; k < kTerms.size(); ++k) {
    joint.equivalent.push_back({kTerms[k], found[at(k)], std::sqrt(spread(at(k), at(k))), true});
  }
}

/// Solves anew without each fold of the training part, with the terms that were selected.
void RobotFitter::leave_out(const BlockSystem& system) {
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    const FitSolution solution = solve(system, without_fold(system, fold), selection_, variance_,
                                       scaled_prior(prior_scale_));
    const auto begin = static_cast<std::size_t>(train_) * fold / kFolds;
    const auto end = static_cast<std::size_t>(train_) * (fold + 1) / kFolds - 1;
    LeftOutFit& left_out =
        left_out_.emplace_back(LeftOutFit{signals_.t[begin], signals_.t[end], {}, solution.rigid});
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      JointFit& joint = left_out.joints.emplace_back();
      joint.name = model_.joints[j].name;
      set_friction(solution, j, joint);
    }
  }
}

void RobotFitter::finish(RobotFit& fit) {
  fit.train_rows = static_cast<std::size_t>(train_);
  fit.inertial_parameters = solution_.rigid;
  fit.fitted_torque.resize(rows_, at(joints_.size()));
  Eigen::Index first = solution_.rigid.size();
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    JointFit& joint = fit.joints[j];
    joint.name = model_.joints[j].name;
    joint.noise_std = noise_[at(j)];
    joint.correlated_rows = correlated_rows_[at(j)];
    set_friction(solution_, j, joint);
    for (std::size_t k = 0; k < joint.friction.size(); ++k) {
      const Eigen::Index place = first + at(k);
      joint.friction[k].std = std::sqrt(solution_.covariance(place, place));
      joint.friction[k].is_excited =
          joint.friction[k].std < 0.3 * prior_.library_std[j][selection_[j][k]];
    }
    set_equivalent(j, first, joint);
    first += at(joint.friction.size());
    const Eigen::VectorXd r = residual(j, solution_);
    joint.train = error_of(j, r, false);
    joint.held_out = error_of(j, r, true);
    fit.fitted_torque.col(at(j)) = joints_[j].torque - r;
  }
  fit.prior_scale = prior_scale_;
  fit.left_out = std::move(left_out_);
  fit.is_physical = true;
  for (Eigen::Index body = 0; body < at(joints_.size()); ++body) {
    fit.is_physical &= physical_margin(solution_.rigid.segment<10>(10 * body)) > 0.0;
  }
  fit.prior_std = scaled_prior(prior_scale_).std;
  fit.base_parameters = base_parameters(
      model_, solution_.rigid,
      solution_.covariance.topLeftCorner(solution_.rigid.size(), solution_.rigid.size()),
      fit.prior_std);
}

}  // namespace detail

RobotModel fitted_robot(const RobotModel& described, const Eigen::VectorXd& inertial_parameters,
                        const std::vector<JointFit>& joints) {
  RobotModel model = with_inertial_parameters(described, inertial_parameters);
  for (std::size_t j = 0; j < joints.size(); ++j) {
    model.joints[j].armature = joints[j].value_of(FrictionTerm::motor_inertia);
  }
  return model;
}

std::size_t RobotFit::excited_base_parameters() const {
  return static_cast<std::size_t>(
      std::count_if(base_parameters.begin(), base_parameters.end(),
                    [](const BaseParameter& entry) { return entry.is_excited; }));
}

RobotModel RobotFit::robot(const RobotModel& described) const {
  return fitted_robot(described, inertial_parameters, joints);
}

RobotFit fit_robot(const JointSignals& signals, const RobotModel& model,
                   const RobotFitOptions& options) {
  return detail::RobotFitter(signals, model, options).run();
}

}  // namespace pcavr
