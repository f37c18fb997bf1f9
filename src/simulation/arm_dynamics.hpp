// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "pcavr/robots/robot/inverse_kinematics.hpp"
#include "pcavr/robots/robot/robot_dynamics.hpp"
#include "pcavr/simulation/plant_arm.hpp"

#include "simulation/bristles.hpp"
#include "simulation/tip_contact.hpp"

namespace pcavr::simulation {

/// Moves an arm under the torques of its controller, joint friction and the load on its tip.
/// Semi-implicit Euler; the controller runs once a millisecond and holds its torques.
class ArmDynamics {
 public:
  explicit ArmDynamics(const PlantArm& arm);

  /// Moves on by `dt` [s], towards the commanded tip (its orientation stays that of the start).
  /// `force` and `torque` [N, N m] are the tip's on its environment, about the tip's centre; base
  /// axes.
  void advance(const Eigen::Vector3d& p_base_command, const Eigen::Vector3d& force,
               const Eigen::Vector3d& torque, double dt);

  [[nodiscard]] const Tip& tip() const { return tip_; }
  [[nodiscard]] PlantArmState state() const { return {q_, dq_, tau_}; }

 private:
  void control(const Eigen::Vector3d& p_base_command);
  void update_tip();
  [[nodiscard]] double friction(Eigen::Index joint, double dt);

  PlantArm arm_;
  RobotDynamics actual_;
  RobotDynamics described_;
  InverseKinematics inverse_;
  Eigen::Quaterniond q_robot_tip_;                     ///< commanded orientation
  std::vector<BristleLaw> laws_;                       ///< by joint: over 1 N m
  std::vector<Eigen::Matrix<double, 1, 1>> bristles_;  ///< deflection [rad]
  double rate_;                                        ///< [rad/s] of the controller
  double since_control_;                               ///< [s]
  Eigen::VectorXd q_, dq_, ddq_, tau_, driving_;
  Eigen::VectorXd gear_, gear_rate_;  ///< of the links against the encoders [rad, rad/s]
  Eigen::VectorXd q_link_, dq_link_, external_;
  Eigen::VectorXd q_command_, dq_command_, q_before_, acceleration_;
  Matrix6Xd jacobian_;
  Tip tip_;
};

}  // namespace pcavr::simulation
