// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot_identification/joint_coupling.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

#include "robots/robot_identification/fit_rows.hpp"
#include "robots/robot_identification/folded_fit.hpp"

namespace pcavr {
namespace {

/// Ratios of a shared transmission: gears of equal or twofold size. With the inverse ratio the
/// joints' parts are exchanged, so that the carrier may be the first of the two.
constexpr std::array<double, 6> kRatios{1.0, -1.0, 0.5, -0.5, 2.0, -2.0};
/// Joints between which a shaft may pass.
constexpr std::size_t kReach = 2;
/// Factor by which a coupling lowers both joints' errors together, in rows left out.
constexpr double kDecisiveCoupling = 1.5;
constexpr std::size_t kMaxCouplings = 3;
constexpr Eigen::Index kMotorTerms = 3;  ///< inertia, viscous, Coulomb
constexpr double kWide = 1e3;            ///< std that leaves a term to the data

/// Factors of a motor's inertia, viscous and Coulomb friction in the torque of a joint.
struct CouplingColumns {
  Eigen::MatrixXd carrier, driven;
};

CouplingColumns columns_of(const JointCoupling& coupling, const JointSignals& signals) {
  const auto carrier = static_cast<Eigen::Index>(coupling.carrier);
  const auto driven = static_cast<Eigen::Index>(coupling.driven);
  const double ratio = coupling.ratio;
  const Eigen::VectorXd speed =
      signals.velocity.col(driven) + ratio * signals.velocity.col(carrier);
  const Eigen::VectorXd sign = (speed.array() / coupling.smoothing_speed).tanh();
  CouplingColumns columns;
  for (const auto& [own, other, factor] :
       {std::tuple{&columns.carrier, driven, ratio}, std::tuple{&columns.driven, carrier, 1.0}}) {
    own->resize(speed.size(), kMotorTerms);
    own->col(0) = ratio * signals.acceleration.col(other);
    own->col(1) = ratio * signals.velocity.col(other);
    own->col(2) = factor * sign;
  }
  return columns;
}

/// Rigid rows with the columns of a coupling, which both joints share as they do the bodies.
std::vector<JointRows> extended_rows(std::vector<JointRows> joints, const JointCoupling& coupling,
                                     const JointSignals& signals) {
  const CouplingColumns columns = columns_of(coupling, signals);
  for (std::size_t j = 0; j < joints.size(); ++j) {
    Eigen::MatrixXd& rigid = joints[j].rigid;
    rigid.conservativeResize(Eigen::NoChange, rigid.cols() + kMotorTerms);
    if (j == coupling.carrier) {
      rigid.rightCols<kMotorTerms>() = columns.carrier;
    } else if (j == coupling.driven) {
      rigid.rightCols<kMotorTerms>() = columns.driven;
    } else {
      rigid.rightCols<kMotorTerms>().setZero();
    }
  }
  return joints;
}

/// A plain fit with motor inertias, and with the columns of couplings beyond the bodies'.
detail::FoldedFit coupled_fit(const JointSignals& signals, const RobotModel& model,
                              std::vector<JointRows> rows, Eigen::Index extra) {
  detail::FoldedFit fit(signals, model, std::move(rows));
  for (std::vector<int>& terms : fit.selection) {
    terms.push_back(column_of(full_library(), FrictionTerm::motor_inertia));
  }
  const Eigen::Index bodies = fit.prior.mean.size();
  fit.prior.mean.conservativeResize(bodies + extra);
  fit.prior.std.conservativeResize(bodies + extra);
  fit.prior.mean.tail(extra).setZero();
  fit.prior.std.tail(extra).setConstant(kWide);
  return fit;
}

/// Looks for one coupling after the other, each beside those that were found before.
class CouplingSearch {
 public:
  CouplingSearch(const JointSignals& signals, const RobotModel& model)
      : signals_(signals),
        model_(model),
        rows_(rigid_rows(signals, model)),
        left_out_(coupled_fit(signals, model, rows_, 0).left_out_misfit()) {}

  [[nodiscard]] std::vector<JointCoupling> run() {
    while (found_.size() < kMaxCouplings) {
      const std::optional<JointCoupling> best = best_candidate();
      if (!best) break;
      rows_ = extended_rows(std::move(rows_), *best, signals_);
      found_.push_back(*best);
      const detail::FoldedFit fit = fit_of(rows_);
      left_out_ = fit.left_out_misfit();
      set_values(fit.solve_all(true));
    }
    return found_;
  }

 private:
  [[nodiscard]] detail::FoldedFit fit_of(const std::vector<JointRows>& rows) const {
    const Eigen::Index bodies = 10 * static_cast<Eigen::Index>(rows.size());
    return coupled_fit(signals_, model_, rows, rows.front().rigid.cols() - bodies);
  }

  /// Values and stds of all that were found.
  void set_values(const FitSolution& solution) {
    Eigen::Index place = 10 * static_cast<Eigen::Index>(rows_.size());
    for (JointCoupling& coupling : found_) {
      for (auto [term, kind] : {std::pair{&coupling.inertia, FrictionTerm::motor_inertia},
                                std::pair{&coupling.viscous, FrictionTerm::viscous},
                                std::pair{&coupling.coulomb, FrictionTerm::coulomb}}) {
        *term = {kind, solution.rigid[place], std::sqrt(solution.covariance(place, place)), true};
        ++place;
      }
    }
  }

  [[nodiscard]] std::optional<JointCoupling> best_candidate() const {
    std::optional<JointCoupling> best;
    const auto consider = [&](JointCoupling candidate) {
      candidate.gain = gain_of(candidate);
      if (candidate.gain > (best ? best->gain : kDecisiveCoupling)) best = candidate;
    };
    for (std::size_t driven = 1; driven < rows_.size(); ++driven) {
      for (std::size_t carrier = driven - std::min(driven, kReach); carrier < driven; ++carrier) {
        if (is_found(carrier, driven)) continue;
        for (const double ratio : kRatios) {
          consider({.carrier = carrier,
                    .driven = driven,
                    .ratio = ratio,
                    .smoothing_speed = kPlainSmoothing});
        }
      }
    }
    if (!best) return best;
    JointCoupling candidate = *best;
    for (const double speed : kSmoothingSpeeds) {
      candidate.smoothing_speed = speed;
      consider(candidate);
    }
    return best;
  }

  [[nodiscard]] bool is_found(std::size_t carrier, std::size_t driven) const {
    for (const JointCoupling& coupling : found_) {
      if (coupling.carrier == carrier && coupling.driven == driven) return true;
    }
    return false;
  }

  /// 1 where it is no coupling: a fold's errors rise, or its friction would drive the arm.
  [[nodiscard]] double gain_of(const JointCoupling& candidate) const {
    const detail::FoldedFit fit = fit_of(extended_rows(rows_, candidate, signals_));
    const FitSolution solution = fit.solve_all();
    if (solution.rigid.tail<2>().minCoeff() < 0.0) return 1.0;
    const Eigen::MatrixXd gained = left_out_ - fit.left_out_misfit();
    const Eigen::VectorXd of_fold = gained.col(static_cast<Eigen::Index>(candidate.carrier)) +
                                    gained.col(static_cast<Eigen::Index>(candidate.driven));
    if (of_fold.minCoeff() <= 0.0) return 1.0;
    return std::exp(of_fold.mean());
  }

  const JointSignals& signals_;
  const RobotModel& model_;
  std::vector<JointRows> rows_;
  Eigen::MatrixXd left_out_;  ///< of the fit with what was found: fold, joint
  std::vector<JointCoupling> found_;
};

}  // namespace

std::vector<JointCoupling> find_couplings(const JointSignals& signals, const RobotModel& model,
                                          double train_share) {
  return CouplingSearch(detail::thinned(signals, train_share), model).run();
}

Eigen::MatrixXd coupling_torque(const std::vector<JointCoupling>& couplings,
                                const JointSignals& signals) {
  Eigen::MatrixXd torque = Eigen::MatrixXd::Zero(signals.torque.rows(), signals.torque.cols());
  for (const JointCoupling& coupling : couplings) {
    const CouplingColumns columns = columns_of(coupling, signals);
    const Eigen::Vector3d terms(coupling.inertia.value, coupling.viscous.value,
                                coupling.coulomb.value);
    torque.col(static_cast<Eigen::Index>(coupling.carrier)) += columns.carrier * terms;
    torque.col(static_cast<Eigen::Index>(coupling.driven)) += columns.driven * terms;
  }
  return torque;
}

void remove_couplings(const std::vector<JointCoupling>& couplings, JointSignals& signals,
                      JointLog& log) {
  if (couplings.empty()) return;
  const Eigen::MatrixXd torque = coupling_torque(couplings, signals);
  const double sign = signals.is_sign_changed ? -1.0 : 1.0;
  signals.torque -= torque;
  for (Eigen::Index j = 0; j < torque.cols(); ++j) {
    log.torque.col(j) -= sign * interpolate(signals.t, torque.col(j), log.t);
  }
}

}  // namespace pcavr
