// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pcavr/core/median.hpp"
#include "pcavr/robot/robot_dynamics.hpp"
#include "pcavr/robot_identification/log_checks.hpp"

#include "robot_identification/fit_rows.hpp"
#include "robot_identification/robot_fitter.hpp"

namespace pcavr {
namespace {

constexpr Eigen::Index kHypothesisRows =
    400;                           ///< of the log, equally spaced: 7 joints, 80 unknowns
constexpr std::size_t kFolds = 5;  ///< of consecutive rows, each left out of a fit in turn
/// A hypothesis is decisive where it lowers the product of the joints' relative errors, in rows
/// that are left out, by this factor. In twelve sound logs of three arms, as recorded and 20 ms
/// late, swaps raised it by 1.07 at least; a sign of a wrist's joint, of which gravity shows
/// little, lowered it by up to 1.15.
constexpr double kDecisiveSwap = 1.05;
constexpr double kDecisive = 3.0;
/// A change that makes the fit of all rows this much worse is not judged fold by fold: of 4547 such
/// swaps in real and simulated logs each would have been found by the folds.
constexpr double kFarWorse = 1e3;
/// Signs and units are tried where they concern a joint with at least this relative error.
constexpr double kPoorFit = 0.3;
constexpr double kKnownMassScale = 0.35;  ///< torque below this share of the description's: current
constexpr double kAligned = 0.8;          ///< correlation of torque and the description's

JointSignals thinned(const JointSignals& signals) {
  JointSignals few = signals;
  const Eigen::Index rows = signals.position.rows();
  const Eigen::Index count = std::min(rows, kHypothesisRows);
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

/// A fit in folds. The prior is that of every fit: without one, the folds of short logs do not
/// predict each other.
struct Trial {
  BlockSystem system;
  Selection selection;
  Eigen::VectorXd variance;
  FitPrior prior;
};

/// `joints`: the rigid rows of the signals.
Trial trial_of(const JointSignals& signals, const RobotModel& model,
               std::vector<JointRows> joints) {
  const std::vector<LibraryColumn>& library = full_library();
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(signals.position.rows());
  const auto count = static_cast<Eigen::Index>(joints.size());
  Trial trial;
  trial.prior = detail::rigid_prior(model, {});
  trial.variance.resize(count);
  for (Eigen::Index j = 0; j < count; ++j) {
    JointRows& joint = joints[static_cast<std::size_t>(j)];
    joint.torque = signals.torque.col(j);
    joint.library = library_columns(
        library,
        {signals, static_cast<std::size_t>(j), none, {.smoothing_speed = kPlainSmoothing}});
    const double power = joint.torque.squaredNorm() / static_cast<double>(joint.torque.size());
    trial.variance[j] = std::max(1e-6, 0.01 * power);
    trial.prior.library_std.emplace_back(Eigen::VectorXd::Constant(joint.library.cols(), 1e3));
  }
  trial.system = block_system(joints, signals.position.rows(), kFolds);
  trial.selection.assign(joints.size(), {column_of(library, FrictionTerm::offset),
                                         column_of(library, FrictionTerm::viscous),
                                         column_of(library, FrictionTerm::coulomb)});
  return trial;
}

Trial trial_of(const JointSignals& signals, const RobotModel& model) {
  return trial_of(signals, model, rigid_rows(signals, model));
}

double log_error(const NormalEquations& equations, const Eigen::VectorXd& parameters) {
  const double floor = 1e-8 * equations.power + 1e-12;
  return 0.5 * std::log((equations.squared_error(parameters) + floor) / (equations.power + floor));
}

/// Log of the relative error of each joint in the fit of all rows.
Eigen::VectorXd fitted_misfit(const Trial& trial) {
  const FitSolution solution = solve(trial.system, std::vector<bool>(kFolds, true), trial.selection,
                                     trial.variance, trial.prior);
  Eigen::VectorXd logs(trial.variance.size());
  for (std::size_t j = 0; j < trial.selection.size(); ++j) {
    NormalEquations equations;
    for (const auto& block : trial.system.blocks) equations.add(block[j]);
    logs[static_cast<Eigen::Index>(j)] = log_error(equations, solution.of_joint(j));
  }
  return logs;
}

/// Log of the relative error in the rows that are left out, summed over joints, by fold.
Eigen::VectorXd left_out_misfit(const Trial& trial) {
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(kFolds);
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    std::vector<bool> is_fitted(kFolds, true);
    is_fitted[fold] = false;
    const FitSolution solution =
        solve(trial.system, is_fitted, trial.selection, trial.variance, trial.prior);
    for (std::size_t j = 0; j < trial.selection.size(); ++j) {
      sums[static_cast<Eigen::Index>(fold)] +=
          log_error(trial.system.blocks[fold][j], solution.of_joint(j));
    }
  }
  return sums;
}

/// Every torque as it is `lag` [s] later.
JointSignals without_lag(const JointSignals& signals, double lag) {
  JointSignals moved = signals;
  std::vector<double> later = signals.t;
  for (double& t : later) t += lag;
  for (Eigen::Index j = 0; j < signals.torque.cols(); ++j) {
    moved.torque.col(j) = interpolate(signals.t, signals.torque.col(j), later);
  }
  return moved;
}

/// Thinned signals without the lag of all torques [s] at which they fit best: late torques fit
/// another joint's place as well as their own.
JointSignals in_step(const JointSignals& signals, const RobotModel& model) {
  constexpr int kEarliest = -5, kLatest = 10;  // steps
  constexpr double kStep = 0.01;               // [s]
  const std::vector<JointRows> joints = rigid_rows(thinned(signals), model);
  JointSignals best;
  double least = std::numeric_limits<double>::max();
  for (int k = kEarliest; k <= kLatest; ++k) {
    JointSignals tried = thinned(without_lag(signals, k * kStep));
    const double sum = fitted_misfit(trial_of(tried, model, joints)).sum();
    if (sum >= least) continue;
    least = sum;
    best = std::move(tried);
  }
  return best;
}

using Change = std::function<void(JointSignals&)>;

struct Hypothesis {
  std::string message;
  std::string hint;
  std::vector<Eigen::Index> joints;  ///< the ones it concerns; none: all
  Change change;
  double decisive = kDecisive;
  double poor_fit = kPoorFit;
  bool is_swap = false;
};

std::string joint_text(const RobotModel& model, Eigen::Index joint) {
  return model.joints[static_cast<std::size_t>(joint)].name;
}

/// The columns of two joints in each other's place.
struct Swap {
  Eigen::Index a = 0, b = 0;
  bool is_of_motion = false, is_of_torque = false;

  void operator()(JointSignals& signals) const {
    if (is_of_torque) signals.torque.col(a).swap(signals.torque.col(b));
    if (!is_of_motion) return;
    for (Eigen::MatrixXd JointSignals::*motion :
         {&JointSignals::position, &JointSignals::velocity, &JointSignals::acceleration}) {
      (signals.*motion).col(a).swap((signals.*motion).col(b));
    }
  }
};

void add_swaps(const RobotModel& model, std::vector<Hypothesis>& hypotheses) {
  const auto count = static_cast<Eigen::Index>(model.dof);
  for (Eigen::Index a = 0; a < count; ++a) {
    for (Eigen::Index b = a + 1; b < count; ++b) {
      const std::string names = joint_text(model, a) + " and " + joint_text(model, b);
      const auto add = [&](std::string message, bool is_of_motion, bool is_of_torque) {
        hypotheses.push_back({.message = std::move(message),
                              .hint = "exchange the columns' names",
                              .joints = {a, b},
                              .change = Swap{a, b, is_of_motion, is_of_torque},
                              .decisive = kDecisiveSwap,
                              .poor_fit = 0.0,
                              .is_swap = true});
      };
      add("the torques of " + names + " are swapped", false, true);
      add("the positions of " + names + " are swapped", true, false);
      add("the joints " + names + " are swapped, in positions and torques", true, true);
    }
  }
}

void add_signs(const RobotModel& model, std::vector<Hypothesis>& hypotheses) {
  for (Eigen::Index j = 0; j < static_cast<Eigen::Index>(model.dof); ++j) {
    hypotheses.push_back(
        {"the torque of " + joint_text(model, j) + " has the opposite sign of the other joints'",
         "change the sign of its column",
         {j},
         [j](JointSignals& s) { s.torque.col(j) *= -1.0; }});
    hypotheses.push_back({"the position of " + joint_text(model, j) +
                              " has the opposite sign of the robot description's axis",
                          "change the sign of its column",
                          {j},
                          [j](JointSignals& s) {
                            s.position.col(j) *= -1.0;
                            s.velocity.col(j) *= -1.0;
                            s.acceleration.col(j) *= -1.0;
                          }});
  }
  hypotheses.push_back(
      {"positions are in degrees, not in radians", "write radians", {}, [](JointSignals& s) {
         constexpr double kRadians = std::numbers::pi / 180.0;
         s.position *= kRadians;
         s.velocity *= kRadians;
         s.acceleration *= kRadians;
       }});
}

/// The torque of the description's bodies, or of equal masses where it has none.
Eigen::MatrixXd described_torque(const JointSignals& signals, const RobotModel& model) {
  constexpr double kMass = 3.0;  // [kg] of a body without one
  Eigen::VectorXd parameters = inertial_parameters(model);
  for (Eigen::Index k = 0; k < parameters.size(); k += 10) {
    if (parameters[k] <= 0.0) parameters[k] = kMass;
  }
  const std::vector<JointRows> joints = rigid_rows(signals, model);
  Eigen::MatrixXd torque(signals.torque.rows(), signals.torque.cols());
  for (std::size_t j = 0; j < joints.size(); ++j) {
    torque.col(static_cast<Eigen::Index>(j)) = joints[j].rigid * parameters;
  }
  return torque;
}

struct Alignment {
  Eigen::VectorXd correlation;  ///< by joint
  Eigen::VectorXd scale;        ///< recorded over described
  Eigen::VectorXd power;        ///< of the described torque
};

Alignment align(const Eigen::MatrixXd& recorded, const Eigen::MatrixXd& described) {
  const Eigen::RowVectorXd power = described.colwise().squaredNorm();
  const Eigen::RowVectorXd product = described.cwiseProduct(recorded).colwise().sum();
  const Eigen::RowVectorXd norm = recorded.colwise().norm();
  const Eigen::RowVectorXd tiny = Eigen::RowVectorXd::Constant(power.size(), 1e-300);
  return {product.cwiseQuotient(norm.cwiseProduct(power.cwiseSqrt()) + tiny).transpose(),
          product.cwiseQuotient(power + tiny).transpose(), power.transpose()};
}

/// Corrects the sign of all torques where they oppose the description's.
void check_sign(const Alignment& alignment, JointSignals& signals, LogFindings& findings) {
  const double vote = alignment.correlation.cwiseProduct(alignment.power).sum();
  if (vote >= -0.5 * alignment.power.sum()) return;
  signals.torque *= -1.0;
  signals.torque_rate *= -1.0;
  signals.is_sign_changed = true;
  findings.warnings.push_back(
      {.message = fmt::format("torques oppose those that hold the robot (correlation {:.2f}): they "
                              "are the load on the joints; their sign was changed",
                              vote / alignment.power.sum()),
       .place = "tau"});
}

void check_scale(const Alignment& alignment, const RobotModel& model, LogFindings& findings) {
  std::vector<double> scales;
  Eigen::Index worst = 0;
  for (Eigen::Index j = 0; j < alignment.scale.size(); ++j) {
    if (std::abs(alignment.correlation[j]) < kAligned) continue;
    scales.push_back(std::abs(alignment.scale[j]));
    if (scales.back() <= *std::min_element(scales.begin(), scales.end())) worst = j;
  }
  if (scales.empty() || !model.has_inertia()) return;
  const double scale = median(scales);
  if (scale >= kKnownMassScale) return;
  findings.errors.push_back(
      {.message = fmt::format("torques are {:.2g} of those of the described masses: currents, or "
                              "another unit",
                              scale),
       .place = "joint " + joint_text(model, worst),
       .hint = "name the columns current_NAME and give --gains, or write N m"});
}

/// Logs of the relative errors of fits under one hypothesis.
struct Misfit {
  Eigen::VectorXd of_joint;  ///< in the fit of all rows
  Eigen::VectorXd of_fold;   ///< in the rows left out, summed over joints

  /// Whether the errors in rows that are left out are hardly larger than those in all rows. In logs
  /// of few seconds they are.
  [[nodiscard]] bool do_folds_predict() const {
    constexpr double kMaxGrowth = 1.4;  // mean of the joints
    return of_fold.mean() - of_joint.sum() <
           std::log(kMaxGrowth) * static_cast<double>(of_joint.size());
  }
};

/// Log of the factor by which `changed` lowers the errors in rows that are left out; 0 where that
/// is not decisive: where all rows then fit worse, or a fold loses more than all folds gain in the
/// mean. Where the folds do not predict each other, a wrong change may gain by chance: each fold
/// has to gain by kDecisive, and so have all rows.
double gain(const Misfit& recorded, const Misfit& changed, double decisive) {
  const double of_all = recorded.of_joint.sum() - changed.of_joint.sum();
  if (of_all <= 0.0) return 0.0;
  const Eigen::VectorXd of_fold = recorded.of_fold - changed.of_fold;
  const double mean = of_fold.mean(), least = of_fold.minCoeff();
  const bool is_decisive = recorded.do_folds_predict()
                               ? mean > std::max(std::log(decisive), -least)
                               : std::min(of_all, least) > std::log(kDecisive);
  return is_decisive ? mean : 0.0;
}

bool concerns_poor_fit(const Hypothesis& hypothesis, const Misfit& recorded) {
  const double poor = std::log(std::max(1e-12, hypothesis.poor_fit));
  const auto is_poor = [&](Eigen::Index j) { return recorded.of_joint[j] > poor; };
  if (hypothesis.joints.empty()) return recorded.of_joint.maxCoeff() > poor;
  return std::any_of(hypothesis.joints.begin(), hypothesis.joints.end(), is_poor);
}

/// Pairs of joints of which a swap would not be found in this log.
class UnseenSwaps {
 public:
  void add(const Hypothesis& hypothesis, const RobotModel& model) {
    const std::string pair = joint_text(model, hypothesis.joints.front()) + " and " +
                             joint_text(model, hypothesis.joints.back());
    if (!pairs_.empty() && pairs_.back() == pair) return;
    pairs_.push_back(pair);
  }
  void report(LogFindings& findings) const {
    if (pairs_.empty()) return;
    findings.warnings.push_back(
        {.message = fmt::format("whether the columns of two joints are swapped does not show in "
                                "this motion for {}: check their order",
                                fmt::join(pairs_, "; "))});
  }

 private:
  std::vector<std::string> pairs_;
};

}  // namespace

LogFindings check_hypotheses(JointSignals& signals, const RobotModel& model) {
  LogFindings findings;
  JointSignals few = thinned(signals);
  const bool has_inertia = model.has_inertia();
  const Alignment alignment = align(few.torque, described_torque(few, model));
  check_sign(alignment, signals, findings);
  if (signals.is_sign_changed) few.torque *= -1.0;
  if (has_inertia) check_scale(alignment, model, findings);
  few = in_step(signals, model);
  std::vector<Hypothesis> hypotheses;
  add_swaps(model, hypotheses);
  add_signs(model, hypotheses);
  const Trial as_recorded = trial_of(few, model);
  const Misfit recorded{fitted_misfit(as_recorded), left_out_misfit(as_recorded)};
  UnseenSwaps unseen;
  double best = 0.0;
  const Hypothesis* found = nullptr;
  for (const Hypothesis& hypothesis : hypotheses) {
    if (!concerns_poor_fit(hypothesis, recorded)) continue;
    JointSignals tried = few;
    hypothesis.change(tried);
    const Trial trial = trial_of(tried, model);
    const Eigen::VectorXd of_joint = fitted_misfit(trial);
    if (of_joint.sum() > recorded.of_joint.sum() + std::log(kFarWorse)) continue;
    const Misfit changed{of_joint, left_out_misfit(trial)};
    // Were the columns swapped, this log would be the change.
    if (hypothesis.is_swap && gain(changed, recorded, hypothesis.decisive) == 0.0) {
      unseen.add(hypothesis, model);
    }
    const double gained = gain(recorded, changed, hypothesis.decisive);
    if (gained <= best) continue;
    best = gained;
    found = &hypothesis;
  }
  if (found == nullptr) {
    unseen.report(findings);
    return findings;
  }
  const std::string place = found->joints.empty() ? "q" : joint_text(model, found->joints.front());
  findings.errors.push_back({.message = fmt::format("{}: the torques then fit {:.3g} times better",
                                                    found->message, std::exp(best)),
                             .line = signals.lines.front(),
                             .place = place,
                             .hint = found->hint});
  return findings;
}

}  // namespace pcavr
