// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <kdl/chain.hpp>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainfdsolver_recursive_newton_euler.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include "pcavr/robots/robot/robot_model.hpp"

namespace pcavr::test {

inline KDL::Vector to_kdl(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

inline KDL::Rotation to_kdl(const Eigen::Matrix3d& R) {
  return {R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)};
}

/// The model's joints as a chain; they must be one.
inline KDL::Chain to_kdl_chain(const RobotModel& model) {
  KDL::Chain chain;
  for (const RobotJoint& joint : model.joints) {
    const KDL::Frame frame(to_kdl(joint.T_parent_joint.rotation_matrix()),
                           to_kdl(joint.T_parent_joint.translation()));
    const KDL::Joint::JointType type =
        joint.kind == JointKind::kPrismatic ? KDL::Joint::TransAxis : KDL::Joint::RotAxis;
    const Eigen::Matrix3d& I = joint.body.inertia_at_com;
    const KDL::RotationalInertia inertia(I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2));
    chain.addSegment(KDL::Segment(
        joint.child_link, KDL::Joint(joint.name, frame.p, frame.M * to_kdl(joint.axis), type),
        frame, KDL::RigidBodyInertia(joint.body.mass, to_kdl(joint.body.centre_of_mass), inertia)));
  }
  return chain;
}

/// The same calls as RobotDynamics, by Orocos KDL.
class KdlPeer {
 public:
  explicit KdlPeer(const RobotModel& model)
      : chain_(to_kdl_chain(model)),
        inverse_(chain_, to_kdl(model.gravity_base)),
        forward_(chain_, to_kdl(model.gravity_base)),
        parameters_(chain_, to_kdl(model.gravity_base)),
        positions_(chain_),
        jacobian_(chain_),
        wrenches_(chain_.getNrOfSegments(), KDL::Wrench::Zero()),
        q_(chain_.getNrOfJoints()),
        dq_(chain_.getNrOfJoints()),
        ddq_(chain_.getNrOfJoints()),
        tau_(chain_.getNrOfJoints()) {}

  void inverse_dynamics(const Eigen::VectorXd& q, const Eigen::VectorXd& dq,
                        const Eigen::VectorXd& ddq, Eigen::VectorXd& tau) {
    q_.data = q;
    dq_.data = dq;
    ddq_.data = ddq;
    inverse_.CartToJnt(q_, dq_, ddq_, wrenches_, tau_);
    tau = tau_.data;
  }
  void forward_dynamics(const Eigen::VectorXd& q, const Eigen::VectorXd& dq,
                        const Eigen::VectorXd& tau, Eigen::VectorXd& ddq) {
    q_.data = q;
    dq_.data = dq;
    tau_.data = tau;
    forward_.CartToJnt(q_, dq_, tau_, wrenches_, ddq_);
    ddq = ddq_.data;
  }
  /// Computes without copies, for benchmarks.
  void inverse_dynamics(const KDL::JntArray& q, const KDL::JntArray& dq, const KDL::JntArray& ddq) {
    inverse_.CartToJnt(q, dq, ddq, wrenches_, tau_);
  }
  void forward_dynamics(const KDL::JntArray& q, const KDL::JntArray& dq, const KDL::JntArray& tau) {
    forward_.CartToJnt(q, dq, tau, wrenches_, ddq_);
  }
  [[nodiscard]] const KDL::JntArray& ddq() const { return ddq_; }
  [[nodiscard]] const KDL::JntArray& tau() const { return tau_; }

  [[nodiscard]] Eigen::MatrixXd mass_matrix(const Eigen::VectorXd& q) {
    q_.data = q;
    KDL::JntSpaceInertiaMatrix mass(chain_.getNrOfJoints());
    parameters_.JntToMass(q_, mass);
    return mass.data;
  }
  [[nodiscard]] Eigen::VectorXd gravity_torque(const Eigen::VectorXd& q) {
    q_.data = q;
    parameters_.JntToGravity(q_, tau_);
    return tau_.data;
  }
  [[nodiscard]] Eigen::Matrix4d tip(const Eigen::VectorXd& q) {
    q_.data = q;
    KDL::Frame frame;
    positions_.JntToCart(q_, frame);
    Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column) T(row, column) = frame(row, column);
    }
    return T;
  }
  [[nodiscard]] Eigen::MatrixXd jacobian(const Eigen::VectorXd& q) {
    q_.data = q;
    KDL::Jacobian jacobian(chain_.getNrOfJoints());
    jacobian_.JntToJac(q_, jacobian);
    return jacobian.data;
  }

 private:
  KDL::Chain chain_;
  KDL::ChainIdSolver_RNE inverse_;
  KDL::ChainFdSolver_RNE forward_;
  KDL::ChainDynParam parameters_;
  KDL::ChainFkSolverPos_recursive positions_;
  KDL::ChainJntToJacSolver jacobian_;
  KDL::Wrenches wrenches_;
  KDL::JntArray q_;
  KDL::JntArray dq_;
  KDL::JntArray ddq_;
  KDL::JntArray tau_;
};

}  // namespace pcavr::test
