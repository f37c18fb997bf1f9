// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robot_identification/payload.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "pcavr/robot/robot_dynamics.hpp"

namespace pcavr {
namespace {

constexpr Eigen::Index kLoad = 10;         ///< inertial parameters of the load
constexpr Eigen::Index kChanges = 3;       ///< of a joint's friction: offset, Coulomb, viscous
constexpr double kChangeOfFriction = 0.1;  ///< std, relative, of warm and cold gears
constexpr double kMassStd = 10.0;          ///< [kg] prior: weaker than any data
constexpr double kInertiaStd = 0.3;        ///< [kg m^2] prior: of 3 kg at 0.3 m

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
        unknowns_(kLoad + kChanges * dof_) {}

  [[nodiscard]] Payload run() {
    Eigen::MatrixXd information = prior();
    Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns_);
    LoadRows rows{Eigen::MatrixXd::Zero(dof_, unknowns_), Eigen::VectorXd::Zero(dof_)};
    const Eigen::VectorXd weight = weights();
    for (Eigen::Index i = 0; i < signals_.position.rows(); ++i) {
      fill(i, rows);
      const Eigen::MatrixXd weighted = weight.asDiagonal() * rows.regressor;
      information += rows.regressor.transpose() * weighted;
      right += weighted.transpose() * rows.torque;
    }
    const Eigen::LDLT<Eigen::MatrixXd> solver(information);
    const Eigen::VectorXd solution = solver.solve(right);
    return payload_of(solution, solver.solve(Eigen::MatrixXd::Identity(unknowns_, unknowns_)));
  }

 private:
  /// Of a row's torque; neighbouring rows of the filtered signals are not independent.
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
    std.segment<6>(4).setConstant(kInertiaStd);
    for (Eigen::Index j = 0; j < dof_; ++j) {
      const JointFit& joint = fit_.joints[static_cast<std::size_t>(j)];
      const double coulomb = std::abs(joint.value_of(FrictionTerm::coulomb)) + joint.noise_std;
      const double viscous = std::abs(joint.value_of(FrictionTerm::viscous)) + joint.noise_std;
      std.segment<kChanges>(kLoad + kChanges * j) =
          kChangeOfFriction * Eigen::Vector3d(coulomb, coulomb, viscous);
    }
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
      tau[j] += friction_torque(joint, q[j], dq[j], tau[j] - armature);
      const double sign = std::tanh(dq[j] / joint.smoothing_speed);
      rows.regressor.block<1, kChanges>(j, kLoad + kChanges * j) =
          Eigen::RowVector3d(1.0, sign, dq[j]);
    }
    rows.torque = signals_.torque.row(row).transpose() +
                  fit_.torque_lag * signals_.torque_rate.row(row).transpose() - tau;
  }

  [[nodiscard]] Payload payload_of(const Eigen::VectorXd& solution,
                                   const Eigen::MatrixXd& covariance) {
    Payload payload;
    payload.mass = solution[0];
    payload.mass_std = std::sqrt(covariance(0, 0));
    payload.centre_of_mass = solution.segment<3>(1) / solution[0];
    for (int axis = 0; axis < 3; ++axis) {
      // Of the quotient m c / m, to first order.
      const double c = payload.centre_of_mass[axis];
      const double variance = covariance(1 + axis, 1 + axis) - 2.0 * c * covariance(0, 1 + axis) +
                              c * c * covariance(0, 0);
      payload.centre_of_mass_std[axis] = std::sqrt(std::max(0.0, variance)) / std::abs(solution[0]);
    }
    payload.inertia = solution.segment<6>(4);
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
};

}  // namespace

Payload identify_payload(const JointSignals& loaded, const RobotModel& model,
                         const RobotFit& unloaded) {
  return PayloadFit(loaded, model, unloaded).run();
}

}  // namespace pcavr
