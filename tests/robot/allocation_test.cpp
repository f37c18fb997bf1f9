// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <string>

#include <gtest/gtest.h>

#include "pcavr/robot/inverse_kinematics.hpp"
#include "pcavr/robot/robot_motion.hpp"
#include "pcavr/robot/urdf.hpp"

#include "support/heap_counter.hpp"
#include "support/source_folder.hpp"

namespace pcavr {
namespace {

TEST(RobotDynamics, CallsDoNotAllocate) {
  const RobotModel model = read_urdf(source_folder() / "calib/robots/pa10/pa10.urdf").value();
  RobotMotion motion(model);
  RobotDynamics& dynamics = motion.dynamics();
  const std::size_t tool = model.link_index("tool").value();
  InverseKinematics solver(model, tool);
  Eigen::VectorXd q = Eigen::VectorXd::Constant(7, 0.4);
  Eigen::VectorXd dq = Eigen::VectorXd::Constant(7, 0.1);
  Eigen::VectorXd tau = Eigen::VectorXd::Zero(7);
  Eigen::VectorXd result = Eigen::VectorXd::Zero(7);
  Eigen::MatrixXd mass(7, 7);
  Eigen::MatrixXd regressor(7, 70);
  Matrix6Xd jacobian(6, 7);
  dynamics.forward_kinematics(q);
  const Pose target = dynamics.T_base_link(tool) * Pose::from_translation({0.05, 0.0, 0.02});
  const long before = heap_allocations;
  dynamics.forward_dynamics(q, dq, tau, result);
  dynamics.inverse_dynamics(q, dq, dq, result);
  dynamics.mass_matrix(q, mass);
  dynamics.gravity_torque(q, result);
  dynamics.regressor(q, dq, dq, regressor);
  dynamics.jacobian(q, tool, jacobian);
  const double energy = dynamics.kinetic_energy(q, dq) + dynamics.potential_energy(q);
  motion.step(tau, 0.001, q, dq);
  const IkResult reached = solver.solve(target, q);
  const IkResult followed = solver.follow(target, 0.001, q);
  EXPECT_EQ(heap_allocations, before);
  EXPECT_NE(energy, 0.0);
  EXPECT_EQ(reached.status, IkStatus::kReached);
  EXPECT_EQ(followed.status, IkStatus::kReached);
}

}  // namespace
}  // namespace pcavr
