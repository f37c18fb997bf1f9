// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "pcavr/robots/robot/robot_dynamics.hpp"
#include "pcavr/robots/robot_identification/robot_fit.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// Defaults and ranges: src/robots/arm/options.cpp.
struct DrivenArmOptions {
  DrivenArmOptions();
  double bandwidth;      ///< [Hz] of the controlled, undamped joints
  double damping_ratio;  ///< of the controlled joints
  /// [kg m^2/(N m)] rotor inertia, seen from the joint, over the torque limit, of joints without a
  /// stated (URDF) or identified one.
  double rotor_inertia_per_torque;
};
[[nodiscard]] OptionSection section_of(DrivenArmOptions& options);

/// An arm moved by torques: the forward dynamics of an identified robot with its joint friction,
/// behind a joint controller (computed torque [Luh, Walker & Paul 1980] with the identified
/// friction compensated) whose torques are limited to those of the description. It lags, is slowed
/// down by its inertia and gives way where it is pushed, as the real one.
///
/// Linearly implicit steps of at most 0.5 ms. After the constructor nothing allocates. Threads: one
/// at a time per object. Vectors by coordinate; [rad, m], [N m, N].
class DrivenArm {
 public:
  using Vector = Eigen::Ref<const Eigen::VectorXd>;

  /// `robot` with identified inertias (RobotFit::robot), or those of its description; `friction` by
  /// coordinate, empty: friction and damping of the description (`<dynamics>`). Throws
  /// ContractError where its bodies have no masses, or for a wrong number of joints.
  DrivenArm(const RobotModel& robot, const std::vector<JointFit>& friction,
            const DrivenArmOptions& options = {});

  /// Puts the arm at rest at `q`, which is the command, too.
  void reset(const Vector& q);
  /// Moves on by `dt` [s] towards a position that is commanded for its end; `external` is the
  /// torque of the environment on the joints (the Jacobian's transpose times the force on the arm).
  void step(const Vector& q_command, const Vector& external, double dt);

  [[nodiscard]] const Eigen::VectorXd& q() const { return q_; }
  [[nodiscard]] const Eigen::VectorXd& dq() const { return dq_; }
  [[nodiscard]] const Eigen::VectorXd& tau() const { return tau_; }  ///< of the motors
  /// The greatest torque wanted over the joint's limit, in the last step; above 1 it was cut.
  [[nodiscard]] double torque_ratio() const { return torque_ratio_; }
  /// The joint of torque_ratio().
  [[nodiscard]] std::size_t loaded_joint() const { return loaded_joint_; }
  [[nodiscard]] RobotDynamics& dynamics() { return dynamics_; }

 private:
  void control(const Vector& q_command, double dt);
  void advance(const Vector& external, double dt);
  void stop_at_limits();

  RobotDynamics dynamics_;
  std::vector<JointFit> friction_;
  double rate_;     ///< [rad/s]
  double damping_;  ///< [1/s]
  Eigen::VectorXd effort_, lower_, upper_;
  Eigen::VectorXd q_, dq_, tau_, q_command_, dq_command_, wanted_, bias_, net_;
  Eigen::MatrixXd mass_;
  Eigen::LDLT<Eigen::MatrixXd> factor_;
  double torque_ratio_ = 0.0;
  std::size_t loaded_joint_ = 0;
};

/// Friction of a joint from its description: Coulomb and viscous. Pure function.
[[nodiscard]] JointFit described_friction(const RobotJoint& joint);

}  // namespace pcavr
