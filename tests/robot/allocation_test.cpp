// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <string>

#include <gtest/gtest.h>

#include "pcavr/robots/robot/arm_follower.hpp"
#include "pcavr/robots/robot/inverse_kinematics.hpp"
#include "pcavr/robots/robot/link_meshes.hpp"
#include "pcavr/robots/robot/robot_motion.hpp"
#include "pcavr/robots/robot/urdf.hpp"

#include "robot/wavy_ground.hpp"
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

TEST(ArmFollower, ACycleDoesNotAllocate) {
  const RobotModel model = read_urdf(source_folder() / "calib/robots/pa10/pa10.urdf").value();
  ArmFollower follower(model, link_meshes(model).value().of_link, default_tip(model),
                       Eigen::VectorXd::Constant(7, 0.4));
  follower.place_surface(follower.add_surface(test::wavy_ground(20)), Pose());
  follower.reset();
  const Eigen::Vector3d p_tip = follower.T_base_tip().translation();
  ArmState copied = follower.state();
  const long before = heap_allocations;
  for (int i = 0; i < 300; ++i) {
    copied = follower.follow(p_tip - Eigen::Vector3d(0.0, 0.0, 0.003 * i), 0.001);
  }
  EXPECT_EQ(heap_allocations, before);
  EXPECT_EQ(copied.q.size(), 7);
}

}  // namespace
}  // namespace pcavr
