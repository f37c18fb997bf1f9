// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot/robot_dynamics.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "robot/bullet_peer.hpp"
#include "robot/kdl_peer.hpp"
#include "robot/random_robot.hpp"

namespace pcavr {
namespace {

using test::random_vector;

double relative_error(const Eigen::MatrixXd& value, const Eigen::MatrixXd& reference) {
  return (value - reference).norm() / reference.norm();
}

struct State {
  Eigen::VectorXd q;
  Eigen::VectorXd dq;
  Eigen::VectorXd x;  ///< ddq or tau
};

State random_state(Random& random, std::size_t dof) {
  return {random_vector(random, dof, 3.0), random_vector(random, dof, 3.0),
          random_vector(random, dof, 20.0)};
}

// Rounding, some 1e-15 by operation, times the condition: of the mass matrix (up to 1e4 here), or
// of a torque in which gravity and inertia nearly cancel.
constexpr double kMaxInverseError = 1e-12;
constexpr double kMaxForwardError = 1e-12;

TEST(RobotDynamics, AgreesWithKdlOnRandomChains) {
  Random random(1);
  double max_inverse = 0.0;
  double max_forward = 0.0;
  for (int robot = 0; robot < 40; ++robot) {
    const RobotModel model =
        test::random_robot(random, {.joints = 1 + static_cast<std::size_t>(robot % 9),
                                    .has_prismatic = robot % 2 == 1,
                                    .has_axis_aligned = robot % 4 >= 2});
    RobotDynamics dynamics(model);
    test::KdlPeer kdl(model);
    Eigen::VectorXd result(model.dof);
    Eigen::VectorXd reference(model.dof);
    Eigen::MatrixXd mass(model.dof, model.dof);
    for (int i = 0; i < 25; ++i) {
      const State state = random_state(random, model.dof);
      dynamics.inverse_dynamics(state.q, state.dq, state.x, result);
      kdl.inverse_dynamics(state.q, state.dq, state.x, reference);
      max_inverse = std::max(max_inverse, relative_error(result, reference));
      dynamics.forward_dynamics(state.q, state.dq, state.x, result);
      kdl.forward_dynamics(state.q, state.dq, state.x, reference);
      max_forward = std::max(max_forward, relative_error(result, reference));
      dynamics.mass_matrix(state.q, mass);
      max_inverse = std::max(max_inverse, relative_error(mass, kdl.mass_matrix(state.q)));
      dynamics.gravity_torque(state.q, result);
      reference = kdl.gravity_torque(state.q);
      // The error is not relative: a sliding joint may be horizontal. Up to some 1000 N m are
      // summed.
      ASSERT_LT((result - reference).norm(), 1e-14 * 1000.0);
    }
  }
  RecordProperty("max_inverse_error", std::to_string(max_inverse * 1e15) + "e-15");
  RecordProperty("max_forward_error", std::to_string(max_forward * 1e15) + "e-15");
  EXPECT_LT(max_inverse, kMaxInverseError);
  EXPECT_LT(max_forward, kMaxForwardError);
}

TEST(RobotDynamics, AgreesWithBulletOnRandomTrees) {
  Random random(2);
  double max_forward = 0.0;
  for (int robot = 0; robot < 40; ++robot) {
    const RobotModel model =
        test::random_robot(random, {.joints = 1 + static_cast<std::size_t>(robot % 9),
                                    .is_chain = false,
                                    .has_prismatic = robot % 2 == 1,
                                    .has_axis_aligned = robot % 4 >= 2});
    RobotDynamics dynamics(model);
    test::BulletPeer bullet(model);
    Eigen::VectorXd result(model.dof);
    Eigen::VectorXd reference(model.dof);
    for (int i = 0; i < 25; ++i) {
      const State state = random_state(random, model.dof);
      dynamics.forward_dynamics(state.q, state.dq, state.x, result);
      bullet.forward_dynamics(state.q, state.dq, state.x, reference);
      max_forward = std::max(max_forward, relative_error(result, reference));
    }
  }
  RecordProperty("max_forward_error", std::to_string(max_forward * 1e15) + "e-15");
  EXPECT_LT(max_forward, kMaxForwardError);
}

TEST(RobotDynamics, PosesAndJacobiansAgreeWithKdl) {
  Random random(3);
  for (int robot = 0; robot < 20; ++robot) {
    const RobotModel model =
        test::random_robot(random, {.joints = 1 + static_cast<std::size_t>(robot % 9),
                                    .has_prismatic = robot % 2 == 1,
                                    .has_axis_aligned = robot % 4 >= 2});
    RobotDynamics dynamics(model);
    test::KdlPeer kdl(model);
    const std::size_t tip = model.links.size() - 1;
    Matrix6Xd jacobian(6, model.dof);
    for (int i = 0; i < 10; ++i) {
      const Eigen::VectorXd q = random_vector(random, model.dof, 3.0);
      dynamics.jacobian(q, tip, jacobian);
      EXPECT_LT((dynamics.T_base_link(tip).matrix() - kdl.tip(q)).norm(), 1e-14 * 20);
      EXPECT_LT((jacobian - kdl.jacobian(q)).norm(), 1e-14 * 20);
    }
  }
}

// The law that holds whatever the sign conventions: forward undoes inverse dynamics.
TEST(RobotDynamics, ForwardUndoesInverseDynamicsWithArmature) {
  Random random(4);
  for (int robot = 0; robot < 20; ++robot) {
    RobotModel model =
        test::random_robot(random, {.joints = 8, .is_chain = false, .has_prismatic = true});
    for (RobotJoint& joint : model.joints) joint.armature = random.uniform(0.0, 0.5);
    RobotDynamics dynamics(model);
    const State state = random_state(random, model.dof);
    Eigen::VectorXd tau(model.dof);
    Eigen::VectorXd ddq(model.dof);
    dynamics.inverse_dynamics(state.q, state.dq, state.x, tau);
    dynamics.forward_dynamics(state.q, state.dq, tau, ddq);
    EXPECT_LT(relative_error(ddq, state.x), kMaxForwardError);
  }
}

// A joint that mimics another, earlier or later in the chain: the dynamics of the free chain,
// projected by dq_joints = G dq.
TEST(RobotDynamics, MimicJointsProjectTheDynamicsOfTheFreeChain) {
  Random random(7);
  const RobotModel free = test::random_robot(random, {.joints = 5, .has_prismatic = true});
  RobotModel model = free;
  model.joints[3].mimics = true;
  model.joints[3].multiplier = -1.5;
  model.joints[3].offset = 0.2;
  const std::size_t coordinates[] = {0, 1, 2, 1, 3};
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(5, 4);
  for (std::size_t i = 0; i < 5; ++i) {
    model.joints[i].coordinate = coordinates[i];
    G(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(coordinates[i])) =
        model.joints[i].multiplier;
  }
  model.dof = 4;
  const State state = random_state(random, 4);
  Eigen::VectorXd q_joints = G * state.q;
  q_joints[3] += 0.2;
  const Eigen::VectorXd dq_joints = G * state.dq;
  const Eigen::VectorXd ddq_joints = G * state.x;
  RobotDynamics dynamics(model);
  RobotDynamics chain(free);
  Eigen::VectorXd tau(4);
  Eigen::VectorXd tau_joints(5);
  dynamics.inverse_dynamics(state.q, state.dq, state.x, tau);
  chain.inverse_dynamics(q_joints, dq_joints, ddq_joints, tau_joints);
  EXPECT_LT(relative_error(tau, G.transpose() * tau_joints), kMaxInverseError);
  Eigen::VectorXd ddq(4);
  dynamics.forward_dynamics(state.q, state.dq, tau, ddq);
  EXPECT_LT(relative_error(ddq, state.x), kMaxForwardError);
  Eigen::MatrixXd mass(4, 4);
  Eigen::MatrixXd mass_joints(5, 5);
  dynamics.mass_matrix(state.q, mass);
  chain.mass_matrix(q_joints, mass_joints);
  EXPECT_LT(relative_error(mass, G.transpose() * mass_joints * G), kMaxInverseError);
  Matrix6Xd jacobian(6, 4);
  Matrix6Xd jacobian_joints(6, 5);
  dynamics.jacobian(state.q, 5, jacobian);
  chain.jacobian(q_joints, 5, jacobian_joints);
  EXPECT_LT(relative_error(jacobian, jacobian_joints * G), kMaxInverseError);
  Eigen::MatrixXd regressor(4, 50);
  dynamics.regressor(state.q, state.dq, state.x, regressor);
  EXPECT_LT(relative_error(regressor * inertial_parameters(model), tau), kMaxInverseError);
}

TEST(RobotDynamics, RegressorTimesParametersIsTheTorque) {
  Random random(5);
  for (int robot = 0; robot < 20; ++robot) {
    const RobotModel model =
        test::random_robot(random, {.joints = 1 + static_cast<std::size_t>(robot % 9),
                                    .is_chain = robot % 3 != 0,
                                    .has_prismatic = robot % 2 == 1,
                                    .has_axis_aligned = robot % 4 >= 2});
    RobotDynamics dynamics(model);
    const State state = random_state(random, model.dof);
    Eigen::VectorXd tau(model.dof);
    Eigen::MatrixXd regressor(model.dof, 10 * model.joints.size());
    dynamics.inverse_dynamics(state.q, state.dq, state.x, tau);
    dynamics.regressor(state.q, state.dq, state.x, regressor);
    EXPECT_LT(relative_error(regressor * inertial_parameters(model), tau), kMaxInverseError);
    // It holds with parameters that the model was not made with, too.
    const Eigen::VectorXd changed =
        inertial_parameters(model) + random_vector(random, 10 * model.joints.size(), 0.01);
    RobotDynamics(with_inertial_parameters(model, changed))
        .inverse_dynamics(state.q, state.dq, state.x, tau);
    EXPECT_LT(relative_error(regressor * changed, tau), kMaxInverseError);
  }
}

}  // namespace
}  // namespace pcavr
