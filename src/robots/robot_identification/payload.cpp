// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot_identification/payload.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pcavr/base/core/solvers.hpp"
#include "pcavr/robots/robot/robot_dynamics.hpp"

#include "robots/robot_identification/load_prior.hpp"

namespace pcavr {
namespace {

constexpr Eigen::Index kChanges = 3;  ///< of a joint's friction: offset, Coulomb, viscous
constexpr double kMassStd = 10.0;     ///< [kg] prior: weaker than any data
constexpr double kLagStd = 0.1;       ///< [s] prior of the change of the torques' lag

/// Torques that the unloaded arm does not explain, and how they depend on the unknowns.
struct LoadRows {
  Eigen::MatrixXd regressor;  ///< rows of one instant: joints
  Eigen::VectorXd torque;
};

class PayloadFit {
 public:
  PayloadFit(const JointSignals& loaded, const RobotModel& model, const RobotFit& unloaded)
      : signals_(loaded),
        fit_(unloaded),
        dynamics_(unloaded.robot(model)),
        dof_(loaded.position.cols()),
        unknowns_(kLoad + kChanges * dof_ + 1),
        sign_(loaded.position.rows(), dof_) {
    for (std::size_t j = 0; j < unloaded.joints.size(); ++j) {
      sign_.col(static_cast<Eigen::Index>(j)) = friction_sign(unloaded.joints[j].sign, loaded, j);
    }
  }

  [[nodiscard]] Payload run(const Eigen::MatrixXd& gain_covariance) {
    Eigen::MatrixXd information = prior();
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(unknowns_, dof_);  // by the joint it is of
    LoadRows rows{Eigen::MatrixXd::Zero(dof_, unknowns_), Eigen::VectorXd::Zero(dof_)};
    const Eigen::VectorXd weight = weights();
    for (Eigen::Index i = 0; i < signals_.position.rows(); ++i) {
      fill(i, rows);
      const Eigen::MatrixXd weighted = weight.asDiagonal() * rows.regressor;
      information += rows.regressor.transpose() * weighted;
      right += weighted.transpose() * rows.torque.asDiagonal();
    }
    const Eigen::LDLT<Eigen::MatrixXd> solver(information);
    Eigen::MatrixXd covariance = solver.solve(Eigen::MatrixXd::Identity(unknowns_, unknowns_));
    // A gain scales its joint's torques in both runs, and so its share of the solution.
    const Eigen::MatrixXd shares = solver.solve(right);
    if (gain_covariance.size() > 0) {
      covariance += shares * gain_covariance * shares.transpose();
    }
    return payload_of(shares.rowwise().sum(), covariance);
  }

 private:
  /// Weights of a row's torques; neighbouring rows of the filtered signals are not independent.
  [[nodiscard]] Eigen::VectorXd weights() const {
    Eigen::VectorXd weight(dof_);
    for (Eigen::Index j = 0; j < dof_; ++j) {
      const JointFit& joint = fit_.joints[static_cast<std::size_t>(j)];
      weight[j] = 1.0 / (std::max(1e-12, joint.noise_std * joint.noise_std) *
                         std::max(1.0, joint.correlated_rows));
    }
    return weight;
  }

  [[nodiscard]] Eigen::MatrixXd prior() const {
    Eigen::VectorXd std = Eigen::VectorXd::Constant(unknowns_, kMassStd);
    std.segment<6>(4).setConstant(kLoadInertiaStd);
    for (Eigen::Index j = 0; j < dof_; ++j) {
      const JointFit& joint = fit_.joints[static_cast<std::size_t>(j)];
      const double coulomb = std::abs(joint.value_of(FrictionTerm::coulomb)) + joint.noise_std;
      const double viscous = std::abs(joint.value_of(FrictionTerm::viscous)) + joint.noise_std;
      std.segment<kChanges>(kLoad + kChanges * j) =
          kChangeOfFriction * Eigen::Vector3d(coulomb, coulomb, viscous);
    }
    std[unknowns_ - 1] = kLagStd;
    return std.cwiseAbs2().cwiseInverse().asDiagonal();
  }

  void fill(Eigen::Index row, LoadRows& rows) {
    const Eigen::VectorXd q = signals_.position.row(row).transpose();
    const Eigen::VectorXd dq = signals_.velocity.row(row).transpose();
    const Eigen::VectorXd ddq = signals_.acceleration.row(row).transpose();
    Eigen::MatrixXd all(dof_, 10 * static_cast<Eigen::Index>(dynamics_.joints()));
    dynamics_.regressor(q, dq, ddq, all);
    Eigen::VectorXd tau(dof_);
    dynamics_.inverse_dynamics(q, dq, ddq, tau);
    rows.regressor.leftCols<kLoad>() = all.rightCols<kLoad>();
    for (Eigen::Index j = 0; j < dof_; ++j) {
      const JointFit& joint = fit_.joints[static_cast<std::size_t>(j)];
      const double armature = joint.value_of(FrictionTerm::motor_inertia) * ddq[j];
      const double sign = sign_(row, j);
      tau[j] += friction_torque(joint, q[j], dq[j], tau[j] - armature, sign);
      rows.regressor.block<1, kChanges>(j, kLoad + kChanges * j) =
          Eigen::RowVector3d(1.0, sign, dq[j]);
    }
    const Eigen::VectorXd rate = signals_.torque_rate.row(row).transpose();
    rows.torque = signals_.torque.row(row).transpose() + fit_.torque_lag * rate - tau;
    rows.regressor.rightCols<1>() = -rate;  // of a further lag of this run's torques
  }

  [[nodiscard]] Payload payload_of(const Eigen::VectorXd& solution,
                                   const Eigen::MatrixXd& covariance) {
    Payload payload;
    payload.mass = solution[0];
    payload.mass_std = std::sqrt(covariance(0, 0));
    payload.centre_of_mass = solution.segment<3>(1) / solution[0];
    for (int axis = 0; axis < 3; ++axis) {
      // Variance of the quotient m c / m, to first order.
      const double c = payload.centre_of_mass[axis];
      const double variance = covariance(1 + axis, 1 + axis) - 2.0 * c * covariance(0, 1 + axis) +
                              c * c * covariance(0, 0);
      payload.centre_of_mass_std[axis] = std::sqrt(std::max(0.0, variance)) / std::abs(solution[0]);
    }
    payload.inertia = solution.segment<6>(4);
    const Eigen::Index lag = unknowns_ - 1;
    payload.torque_lag = {solution[lag], std::sqrt(covariance(lag, lag))};
    payload.torque_rms = payload.residual_rms = Eigen::VectorXd::Zero(dof_);
    LoadRows rows{Eigen::MatrixXd::Zero(dof_, unknowns_), Eigen::VectorXd::Zero(dof_)};
    for (Eigen::Index i = 0; i < signals_.position.rows(); ++i) {
      fill(i, rows);
      const Eigen::VectorXd load = rows.regressor.leftCols<kLoad>() * solution.head<kLoad>();
      payload.torque_rms += load.cwiseAbs2();
      payload.residual_rms += (rows.torque - rows.regressor * solution).cwiseAbs2();
    }
    const auto count = static_cast<double>(signals_.position.rows());
    payload.torque_rms = (payload.torque_rms / count).cwiseSqrt();
    payload.residual_rms = (payload.residual_rms / count).cwiseSqrt();
    return payload;
  }

  const JointSignals& signals_;
  const RobotFit& fit_;
  RobotDynamics dynamics_;
  Eigen::Index dof_;
  Eigen::Index unknowns_;
  Eigen::MatrixXd sign_;  ///< of Coulomb friction
};

/// The fit of the unloaded arm without one stretch of its rows.
RobotFit without_stretch(const RobotFit& whole, const LeftOutFit& left_out) {
  RobotFit fit = whole;
  fit.inertial_parameters = left_out.inertial_parameters;
  for (std::size_t j = 0; j < fit.joints.size(); ++j) {
    fit.joints[j].friction = left_out.joints[j].friction;
    fit.joints[j].stribeck_speed = left_out.joints[j].stribeck_speed;
  }
  return fit;
}

double with_variance(double std, double variance) { return std::sqrt(std * std + variance); }

}  // namespace

Eigen::MatrixXd given_gain_covariance(Eigen::Index dof, double std) {
  constexpr double kOwnShare = 0.5;  // std of a drive's own error over that of the common one
  return std * std *
         (Eigen::MatrixXd::Ones(dof, dof) +
          kOwnShare * kOwnShare * Eigen::MatrixXd::Identity(dof, dof));
}

Payload identify_payload(const JointSignals& loaded, const RobotModel& model,
                         const RobotFit& unloaded, const Eigen::MatrixXd& gain_covariance) {
  Payload payload = PayloadFit(loaded, model, unloaded).run(gain_covariance);
  // The unloaded fit's share, by the jackknife [Tukey 1958]: what the load is without each stretch.
  std::vector<Eigen::Vector4d> found;
  for (const LeftOutFit& left_out : unloaded.left_out) {
    const RobotFit fit = without_stretch(unloaded, left_out);
    const Payload without = PayloadFit(loaded, model, fit).run({});
    found.emplace_back(without.mass, without.centre_of_mass.x(), without.centre_of_mass.y(),
                       without.centre_of_mass.z());
  }
  if (found.size() < 2) return payload;
  const auto count = static_cast<double>(found.size());
  Eigen::Vector4d mean = Eigen::Vector4d::Zero(), squares = mean;
  for (const Eigen::Vector4d& values : found) mean += values / count;
  for (const Eigen::Vector4d& values : found) squares += (values - mean).cwiseAbs2();
  const Eigen::Vector4d variance = squares * (count - 1.0) / count;
  payload.mass_std = with_variance(payload.mass_std, variance[0]);
  for (int axis = 0; axis < 3; ++axis) {
    double& std = payload.centre_of_mass_std[axis];
    std = with_variance(std, variance[1 + axis]);
  }
  return payload;
}

}  // namespace pcavr
