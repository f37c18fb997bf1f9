// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/robots/robot/robot_model.hpp"

/// The arm that carries the tip of a simulated plant, with what its description does not state.
namespace pcavr {

/// Friction and gear of one joint of the plant's arm. Friction is LuGre's with Stribeck effect
/// [Canudas de Wit et al. 1995], which no fit of pcavr uses: those take tanh(v).
struct PlantJoint {
  double static_friction = 1.0;        ///< at breakaway [N m], > 0
  double coulomb_friction = 0.8;       ///< [N m], at most the static friction, > 0
  double viscous_friction = 1.0;       ///< [N m s/rad]
  double stribeck_speed = 0.02;        ///< [rad/s]
  double breakaway_deflection = 1e-3;  ///< of the bristles [rad]
  double gear_stiffness = 2e4;         ///< [N m/rad] between encoder and link, > 0
};

/// A torque-driven arm: its own dynamics with friction in the joints and elastic gears, behind a
/// controller that knows both only roughly.
struct PlantArm {
  RobotModel described;  ///< the description as published: kinematics, and what the controller uses
  RobotModel actual;     ///< the same joints with the actual masses and rotor inertias
  std::size_t tip = 0;   ///< link whose origin is the centre of the spherical tip
  Pose T_base_robot;
  Eigen::VectorXd q_start;         ///< [rad], at rest
  std::vector<PlantJoint> joints;  ///< by coordinate
  double bandwidth = 15.0;         ///< [Hz] of the controlled, undamped joints
  /// Part of Coulomb and viscous friction that the controller compensates.
  double compensated_friction = 0.8;
};

/// The arm at one instant, by coordinate.
struct PlantArmState {
  Eigen::VectorXd q;    ///< of the encoders [rad]
  Eigen::VectorXd dq;   ///< [rad/s]
  Eigen::VectorXd tau;  ///< of the motors, behind the gear [N m]
};

}  // namespace pcavr
