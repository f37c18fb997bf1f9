// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot_identification/friction_intervals.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "pcavr/base/core/solvers.hpp"

#include "robots/robot_identification/friction_torques.hpp"

namespace pcavr {
namespace {

constexpr std::array<FrictionTerm, 3> kTableTerms{FrictionTerm::offset, FrictionTerm::viscous,
                                                  FrictionTerm::coulomb};

/// The normal equations of one interval's changes.
struct IntervalSystem {
  Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  std::size_t rows = 0;
};

class JointTable {
 public:
  JointTable(const JointSignals& signals, const detail::FrictionTorques& torques,
             const RobotFit& fit, std::size_t index, const FrictionIntervalOptions& options)
      : signals_(signals),
        joint_(fit.joints[index]),
        index_(static_cast<Eigen::Index>(index)),
        train_(static_cast<Eigen::Index>(fit.train_rows)),
        residual_(torques.friction.col(index_)),
        sign_(friction_sign(joint_.sign, signals, index)) {
    for (Eigen::Index row = 0; row < residual_.size(); ++row) {
      residual_[row] -=
          friction_torque(joint_, signals.position(row, index_), signals.velocity(row, index_),
                          torques.rigid(row, index_), sign_[row]);
    }
    const auto fitted = signals.position.col(index_).head(train_);
    begin_ = fitted.minCoeff();
    width_ = std::max(1e-6, (fitted.maxCoeff() - begin_) / options.intervals);
    solve(options);
  }

  [[nodiscard]] JointIntervals table(const detail::FrictionTorques& torques) const {
    JointIntervals found{intervals_, {}, {}};
    Eigen::VectorXd residual = residual_;
    for (Eigen::Index row = 0; row < residual.size(); ++row) {
      residual[row] -= columns_at(row).dot(changes_[interval_at(row)]);
    }
    const Eigen::Index rest = residual.size() - train_;
    const auto measured = torques.measured.col(index_);
    found.train = detail::torque_error(residual.head(train_), measured.head(train_));
    found.held_out = detail::torque_error(residual.tail(rest), measured.tail(rest));
    return found;
  }

 private:
  [[nodiscard]] std::size_t interval_at(Eigen::Index row) const {
    const double place = (signals_.position(row, index_) - begin_) / width_;
    const double last = static_cast<double>(intervals_.size() - 1);
    return static_cast<std::size_t>(std::clamp(std::floor(place), 0.0, last));
  }
  [[nodiscard]] Eigen::Vector3d columns_at(Eigen::Index row) const {
    return {1.0, signals_.velocity(row, index_), sign_[row]};
  }

  void solve(const FrictionIntervalOptions& options) {
    intervals_.resize(static_cast<std::size_t>(options.intervals));
    std::vector<IntervalSystem> systems(intervals_.size());
    for (Eigen::Index row = 0; row < train_; ++row) {
      const Eigen::Vector3d columns = columns_at(row);
      IntervalSystem& system = systems[interval_at(row)];
      system.gram += columns * columns.transpose();
      system.right += residual_[row] * columns;
      ++system.rows;
    }
    const double coulomb = std::abs(joint_.value_of(FrictionTerm::coulomb));
    const double viscous = std::abs(joint_.value_of(FrictionTerm::viscous));
    // An offset is what is wrong with gravity or Coulomb friction: as uncertain as the latter.
    const Eigen::Vector3d prior_std =
        (options.prior_share * Eigen::Vector3d(coulomb, viscous, coulomb)).cwiseMax(1e-6);
    const double variance = std::pow(joint_.noise_std, 2) * std::max(1.0, joint_.correlated_rows);
    for (std::size_t i = 0; i < intervals_.size(); ++i) {
      Eigen::Matrix3d information = systems[i].gram / variance;
      information.diagonal() += prior_std.cwiseAbs2().cwiseInverse();
      const Eigen::Matrix3d covariance =
          information.ldlt().solve(Eigen::Matrix3d::Identity().eval());
      changes_.emplace_back(covariance * systems[i].right / variance);
      FrictionInterval& interval = intervals_[i];
      interval.begin = begin_ + static_cast<double>(i) * width_;
      interval.end = interval.begin + width_;
      interval.rows = systems[i].rows;
      for (std::size_t k = 0; k < kTableTerms.size(); ++k) {
        const auto at = static_cast<Eigen::Index>(k);
        const double std = std::sqrt(covariance(at, at));
        interval.terms.push_back({kTableTerms[k], joint_.value_of(kTableTerms[k]) + changes_[i][at],
                                  std, std < 0.5 * prior_std[at]});
      }
    }
  }

  const JointSignals& signals_;
  const JointFit& joint_;
  Eigen::Index index_, train_;
  Eigen::VectorXd residual_;  ///< [N m] that the whole motion's friction leaves
  Eigen::VectorXd sign_;
  double begin_ = 0.0, width_ = 1.0;
  std::vector<FrictionInterval> intervals_;
  std::vector<Eigen::Vector3d> changes_;
};

}  // namespace

std::vector<JointIntervals> friction_by_interval(const JointSignals& signals,
                                                 const RobotModel& described, const RobotFit& fit,
                                                 const FrictionIntervalOptions& options) {
  const detail::FrictionTorques torques =
      detail::friction_torques(signals, fit.robot(described), fit);
  std::vector<JointIntervals> found;
  for (std::size_t j = 0; j < fit.joints.size(); ++j) {
    found.push_back(JointTable(signals, torques, fit, j, options).table(torques));
  }
  return found;
}

}  // namespace pcavr
