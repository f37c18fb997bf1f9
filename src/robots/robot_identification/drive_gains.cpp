// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot_identification/drive_gains.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/median.hpp"
#include "pcavr/base/core/solvers.hpp"

#include "robots/robot_identification/load_prior.hpp"
#include "robots/robot_identification/robot_fitter.hpp"

namespace pcavr {
namespace {

using detail::at;

constexpr double kSignSpeed = 0.05;  ///< [rad/s] of the sign of a speed
constexpr double kKnownMass = 1e-4;  ///< std of the load's mass, relative
constexpr double kGainStd = 10.0;    ///< of a gain's relative change: left to the data
constexpr double kMaxChange = 0.5;   ///< of a gain in one round
constexpr double kSettled = 1e-5;    ///< the same
constexpr int kMaxRounds = 50;

/// Columns of a joint's own: friction of both runs, its change in the loaded one, the gain's
/// change.
enum Column { kOffset, kViscous, kCoulomb, kMotorInertia, kChange, kGain = kChange + 3, kColumns };

class GainFit {
 public:
  GainFit(const JointSignals& unloaded, const JointSignals& loaded, const RobotModel& model,
          double load_mass, const RobotFitOptions& options)
      : rows_(unloaded.position.rows() + loaded.position.rows()),
        joints_(stacked(rigid_rows(unloaded, model), rigid_rows(loaded, model))) {
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      currents_.emplace_back(joints_[j].torque);
      fill_library(unloaded, loaded, j);
    }
    prior_ = detail::rigid_prior(model, options);
    const Eigen::Index bodies = prior_.mean.size();
    prior_.mean.conservativeResize(bodies + kLoad);
    prior_.std.conservativeResize(bodies + kLoad);
    prior_.mean.tail<kLoad>().setZero();
    prior_.mean[bodies] = load_mass;
    prior_.std[bodies] = kKnownMass * load_mass;
    prior_.std.segment<3>(bodies + 1).setConstant(load_mass);
    prior_.std.tail<6>().setConstant(kLoadInertiaStd);
  }

  [[nodiscard]] DriveGains run() {
    start();
    FitSolution solution;
    solution.rigid = prior_.mean;
    Eigen::VectorXd variance = Eigen::VectorXd::Ones(at(joints_.size()));
    for (int round = 0; round < kMaxRounds; ++round) {
      solution = step(solution, variance);
      double largest = 0.0;
      for (std::size_t j = 0; j < joints_.size(); ++j) {
        const double change = std::clamp(solution.library[j][kGain], -kMaxChange, kMaxChange);
        gain_[at(j)] /= 1.0 + change;
        largest = std::max(largest, std::abs(change));
      }
      if (largest < kSettled) break;
    }
    DriveGains found{gain_, gain_};
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      const Eigen::Index place = solution.rigid.size() + kColumns * at(j) + kGain;
      found.std[at(j)] = std::abs(gain_[at(j)]) * std::sqrt(solution.covariance(place, place));
    }
    return found;
  }

 private:
  /// The rows of both runs; the load's columns are 0 in the unloaded one.
  [[nodiscard]] static std::vector<JointRows> stacked(std::vector<JointRows> unloaded,
                                                      const std::vector<JointRows>& loaded) {
    for (std::size_t j = 0; j < unloaded.size(); ++j) {
      const JointRows without = std::move(unloaded[j]);
      const JointRows& with = loaded[j];
      const Eigen::Index first = without.rigid.rows(), second = with.rigid.rows();
      const Eigen::Index bodies = without.rigid.cols();
      JointRows& both = unloaded[j];
      both.rigid.setZero(first + second, bodies + kLoad);
      both.rigid.topLeftCorner(first, bodies) = without.rigid;
      both.rigid.bottomLeftCorner(second, bodies) = with.rigid;
      both.rigid.bottomRightCorner(second, kLoad) = with.rigid.rightCols<kLoad>();
      both.torque.resize(first + second);
      both.torque << without.torque, with.torque;
      both.weight.setOnes(first + second);
    }
    return unloaded;
  }

  void fill_library(const JointSignals& unloaded, const JointSignals& loaded, std::size_t joint) {
    Eigen::MatrixXd& library = joints_[joint].library;
    library.setZero(rows_, kColumns);
    Eigen::Index first = 0;
    for (const JointSignals* run : {&unloaded, &loaded}) {
      const Eigen::VectorXd speed = run->velocity.col(at(joint));
      auto rows = library.middleRows(first, speed.size());
      rows.col(kOffset).setOnes();
      rows.col(kViscous) = speed;
      rows.col(kCoulomb) = (speed.array() / kSignSpeed).tanh();
      rows.col(kMotorInertia) = run->acceleration.col(at(joint));
      if (run == &loaded) rows.middleCols<3>(kChange) = rows.leftCols<3>();
      first += speed.size();
    }
  }

  /// Starts with a fit of each joint's current against the torque of the described bodies, and
  /// friction.
  void start() {
    gain_.resize(at(joints_.size()));
    std::vector<double> sizes;
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      Eigen::MatrixXd matrix(rows_, 5);
      matrix << joints_[j].rigid * prior_.mean, joints_[j].library.leftCols<4>();
      const Eigen::VectorXd fitted = matrix.colPivHouseholderQr().solve(currents_[j]);
      gain_[at(j)] = 1.0 / fitted[0];
      sizes.push_back(std::abs(gain_[at(j)]));
    }
    // A joint whose bodies' torque is small beside its friction starts as the others do.
    const double middle = std::copysign(median(sizes), gain_.cwiseSign().sum());
    for (double& gain : gain_) {
      const double ratio = std::abs(gain / middle);
      if (!(ratio > 0.2 && ratio < 5.0)) gain = middle;
    }
  }

  /// One round: everything that is linear, and the gains' relative changes.
  [[nodiscard]] FitSolution step(const FitSolution& before, Eigen::VectorXd& variance) {
    prior_.library_std.clear();
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      JointRows& rows = joints_[j];
      rows.torque = gain_[at(j)] * currents_[j];
      rows.library.col(kGain) = rows.rigid * before.rigid;
      const double size = std::sqrt(rows.torque.squaredNorm() / double(rows_));
      Eigen::VectorXd& std =
          prior_.library_std.emplace_back(Eigen::VectorXd::Constant(kColumns, 10.0 * size));
      std.segment<3>(kChange).setConstant(kChangeOfFriction * size);
      std[kGain] = kGainStd;
    }
    std::vector<int> all(kColumns);
    for (int k = 0; k < kColumns; ++k) all[static_cast<std::size_t>(k)] = k;
    const FitSolution solution = solve(block_system(joints_, rows_, 1), {true},
                                       Selection(joints_.size(), all), variance, prior_, true);
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      const JointRows& rows = joints_[j];
      const Eigen::VectorXd residual =
          rows.torque - rows.rigid * solution.rigid - rows.library * solution.library[j];
      variance[at(j)] = std::max(1e-18, residual.squaredNorm() / double(rows_)) *
                        detail::correlated_rows(residual);
    }
    return solution;
  }

  Eigen::Index rows_;
  std::vector<JointRows> joints_;
  std::vector<Eigen::VectorXd> currents_;  ///< [A] by joint
  FitPrior prior_;
  Eigen::VectorXd gain_;
};

}  // namespace

DriveGains identify_drive_gains(const JointSignals& unloaded, const JointSignals& loaded,
                                const RobotModel& model, double load_mass,
                                const RobotFitOptions& options) {
  PCAVR_REQUIRE(load_mass > 0.0, load_mass);
  return GainFit(unloaded, loaded, model, load_mass, options).run();
}

}  // namespace pcavr
