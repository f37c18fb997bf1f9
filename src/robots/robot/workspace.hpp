// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "robots/robot/body_tree.hpp"

namespace pcavr::robot {

/// The pose of a frame in the base frame.
struct Placement {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
};

/// The variables of one body, in its body axes if nothing else is said.
struct BodyState {
  Turn turn;         ///< of Rz in the rotation from the parent
  Vec origin;        ///< in the parent's body axes
  VecPair rotation;  ///< omega, domega
  Vec acceleration;  ///< of the origin, minus gravity
  Rows spin;         ///< skew(domega) + skew(omega)^2: acceleration of a point is spin * r more
  VecPair force;     ///< moment about the origin, force
  ArticulatedInertia inertia;
  VecPair force_of_joint;   ///< U of Featherstone: inertia times the joint's axis
  double inverse_inertia;   ///< 1 / D of Featherstone
  double remaining_torque;  ///< u of Featherstone
  VecPair relative;         ///< domega and acceleration, relative to the motion without ddq
};

/// The working memory of RobotDynamics and its recursions. set_positions comes before all others.
class Workspace {
 public:
  explicit Workspace(BodyTree body_tree);

  void set_positions(const double* q);
  /// Fills `places`.
  void place_bodies();
  [[nodiscard]] Placement place_of_link(std::size_t link) const;

  void inverse_dynamics(const double* dq, const double* ddq, double* tau);
  void gravity_torque(double* tau);
  /// Solves by articulated bodies; not for models with joints that mimic others.
  void forward_dynamics(const double* dq, const double* tau, double* ddq);
  /// Solves by the mass matrix and its Cholesky factors; for all models.
  void solve_with_mass_matrix(const double* dq, const double* tau, double* ddq);
  /// Fills `mass`.
  void fill_mass_matrix();
  void fill_regressor(const double* dq, const double* ddq, Eigen::Ref<Eigen::MatrixXd> regressor);
  [[nodiscard]] double kinetic_energy(const double* dq);

  BodyTree tree;
  std::vector<Placement> places;  ///< of the body axes in the base frame
  Eigen::MatrixXd mass;           ///< dof x dof

 private:
  template <bool kHasAcceleration>
  void move_bodies(const double* dq, const double* ddq);
  void sum_forces(double* tau);
  void fold_inertias(const double* tau);
  void accelerate_bodies(double* ddq);

  std::vector<BodyState> states_;
  std::vector<double> angles_;  ///< of the bodies' turns [rad]
  Eigen::MatrixXd factor_;
  Eigen::VectorXd bias_;
};

}  // namespace pcavr::robot
