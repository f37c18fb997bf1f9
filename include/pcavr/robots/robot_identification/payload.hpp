// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "pcavr/robots/robot/robot_model.hpp"
#include "pcavr/robots/robot_identification/joint_signals.hpp"
#include "pcavr/robots/robot_identification/robot_fit.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// Defaults and ranges: src/robots/robot_identification/options.cpp.
struct PayloadOptions {
  PayloadOptions();
  double gain_std;  ///< relative, of gains that were given for the drives' currents
};
[[nodiscard]] OptionSection section_of(PayloadOptions& options);

/// Covariance of the relative errors of `dof` gains that were given, each with this relative std:
/// most of an error is common to all drives (the torque of a current is the same motor's, warm or
/// cold, and the gears' efficiency), half as much again is each drive's own. Pure function.
[[nodiscard]] Eigen::MatrixXd given_gain_covariance(Eigen::Index dof, double std);

/// The load that an arm carries in one run and not in another. Standard deviations are of the
/// loaded run's noise, of the unloaded fit, and of the gains that turned currents into torques.
struct Payload {
  double mass = 0.0;      ///< [kg]
  double mass_std = 0.0;  ///< [kg]
  /// [m] in the frame of the last joint's child link; without meaning where the mass is less than
  /// a few standard deviations.
  Eigen::Vector3d centre_of_mass = Eigen::Vector3d::Zero();
  Eigen::Vector3d centre_of_mass_std = Eigen::Vector3d::Zero();  ///< [m]
  /// The inertia about the joint frame's origin: Ixx, Ixy, Ixz, Iyy, Iyz, Izz [kg m^2].
  Eigen::Matrix<double, 6, 1> inertia = Eigen::Matrix<double, 6, 1>::Zero();
  EstimatedLag torque_lag;       ///< of its torques after the unloaded run's; is removed
  Eigen::VectorXd torque_rms;    ///< [N m] of the load by joint: what the load adds
  Eigen::VectorXd residual_rms;  ///< [N m] that it does not explain
};

/// The load on the last body from a loaded run, given the fit of an unloaded one: the torques that
/// the unloaded arm does not explain are linear in the load's ten inertial parameters [Atkeson, An
/// & Hollerbach 1986]. Friction may change by a tenth between the runs (another temperature):
/// offset, Coulomb and viscous changes are fitted along, with that prior, and so is a lag of the
/// loaded torques after those of the unloaded run. `model`: of the unloaded
/// fit, with the signals' joints. `gain_covariance`: of the relative errors of the gains that both
/// runs' torques were made with, by joint; empty for recorded torques. Deterministic; pure
/// function.
[[nodiscard]] Payload identify_payload(const JointSignals& loaded, const RobotModel& model,
                                       const RobotFit& unloaded,
                                       const Eigen::MatrixXd& gain_covariance = {});

}  // namespace pcavr
