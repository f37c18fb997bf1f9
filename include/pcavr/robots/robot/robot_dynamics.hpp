// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>

#include <Eigen/Core>

#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/robots/robot/robot_model.hpp"

namespace pcavr {

using Matrix6Xd = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/// Kinematics and rigid-body dynamics of a robot: M(q) ddq + C(q, dq) dq + g(q) = tau.
///
/// Vectors have model.dof numbers in the order of RobotJoint::coordinate; [rad, m], their time
/// derivatives, and [N m, N]. Friction is not included; armature is. Links fixed to the base do not
/// count. Matrices are filled, and must have the size stated.
///
/// The constructor copies what it needs of the model. After it nothing allocates, and calls only
/// depend on their arguments. Threads: one at a time per object; copies are independent. Throws
/// ContractError for a wrong size.
///
/// Algorithms: Featherstone, Rigid Body Dynamics Algorithms (2008): recursive Newton-Euler (table
/// 5.1), composite rigid body (table 6.2), articulated body (table 7.1), in link coordinates
/// (src/robots/robot/README.md has the form used here).
class RobotDynamics {
 public:
  explicit RobotDynamics(const RobotModel& model);
  RobotDynamics(const RobotDynamics& other);
  RobotDynamics(RobotDynamics&& other) noexcept;
  RobotDynamics& operator=(const RobotDynamics& other);
  RobotDynamics& operator=(RobotDynamics&& other) noexcept;
  ~RobotDynamics();

  using Vector = Eigen::Ref<const Eigen::VectorXd>;

  [[nodiscard]] std::size_t dof() const;
  /// Number of movable joints, those that mimic others included.
  [[nodiscard]] std::size_t joints() const;
  [[nodiscard]] std::size_t links() const;

  /// Computes the poses of all links, for T_base_link.
  void forward_kinematics(const Vector& q);
  /// Pose of a link at the latest forward_kinematics or jacobian; index as in RobotModel::links.
  [[nodiscard]] Pose T_base_link(std::size_t link) const;

  /// [v; omega] of the link's frame = jacobian * dq: v of its origin (or of the point `p_link`,
  /// fixed to it) and omega in base axes. 6 x dof. Updates the poses of the links.
  void jacobian(const Vector& q, std::size_t link, Eigen::Ref<Matrix6Xd> jacobian,
                const Eigen::Vector3d& p_link = Eigen::Vector3d::Zero());

  /// The torque for an acceleration.
  void inverse_dynamics(const Vector& q, const Vector& dq, const Vector& ddq,
                        Eigen::Ref<Eigen::VectorXd> tau);

  /// The acceleration under a torque. Needs RobotModel::has_inertia (or armature); otherwise the
  /// result is not finite.
  void forward_dynamics(const Vector& q, const Vector& dq, const Vector& tau,
                        Eigen::Ref<Eigen::VectorXd> ddq);

  /// Symmetric, both triangles filled, dof x dof [kg m^2] and the like.
  void mass_matrix(const Vector& q, Eigen::Ref<Eigen::MatrixXd> mass);

  /// The torque that holds the robot at rest.
  void gravity_torque(const Vector& q, Eigen::Ref<Eigen::VectorXd> tau);

  /// dof x 10 joints; regressor * inertial_parameters(model) is the torque of inverse_dynamics,
  /// without the armature's.
  void regressor(const Vector& q, const Vector& dq, const Vector& ddq,
                 Eigen::Ref<Eigen::MatrixXd> regressor);

  [[nodiscard]] double kinetic_energy(const Vector& q, const Vector& dq);  ///< [J]
  /// Potential energy of gravity [J], 0 where all bodies' common centre of mass is at the height of
  /// the base.
  [[nodiscard]] double potential_energy(const Vector& q);

 private:
  struct Workspace;
  std::unique_ptr<Workspace> workspace_;
};

}  // namespace pcavr
