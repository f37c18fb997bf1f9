// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "pcavr/robots/robot/robot_model.hpp"

namespace pcavr::test {

inline btVector3 to_bullet(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// Forward dynamics by Bullet's btMultiBody, for trees too. Its links are at the centres of mass,
/// in principal axes. Gravity is a force on each link, as its worlds apply it.
class BulletPeer {
 public:
  explicit BulletPeer(const RobotModel& model)
      : gravity_(to_bullet(model.gravity_base)),
        body_(static_cast<int>(model.joints.size()), 1.0, btVector3(1.0, 1.0, 1.0), true, false) {
    body_.setLinearDamping(0.0);
    body_.setAngularDamping(0.0);
    std::vector<Pose> T_joint_principal;
    for (std::size_t i = 0; i < model.joints.size(); ++i) {
      const RobotJoint& joint = model.joints[i];
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(joint.body.inertia_at_com);
      Eigen::Matrix3d axes = solver.eigenvectors();
      if (axes.determinant() < 0.0) axes.col(0) = -axes.col(0);
      T_joint_principal.push_back(Pose(Eigen::Quaterniond(axes), joint.body.centre_of_mass));
      const Pose T_parent_joint =
          joint.parent ? T_joint_principal[*joint.parent].inverse() * joint.T_parent_joint
                       : joint.T_parent_joint;
      const Pose& T_own = T_joint_principal.back();
      const Eigen::Quaterniond turn = (T_parent_joint * T_own).rotation().conjugate();
      const btQuaternion rotation(turn.x(), turn.y(), turn.z(), turn.w());
      const Eigen::Vector3d axis = T_own.rotation().conjugate() * joint.axis;
      const Eigen::Vector3d to_com = T_own.rotation().conjugate() * joint.body.centre_of_mass;
      const int parent = joint.parent ? static_cast<int>(*joint.parent) : -1;
      const auto setup = joint.kind == JointKind::kPrismatic ? &btMultiBody::setupPrismatic
                                                             : &btMultiBody::setupRevolute;
      (body_.*setup)(static_cast<int>(i), joint.body.mass, to_bullet(solver.eigenvalues()), parent,
                     rotation, to_bullet(axis), to_bullet(T_parent_joint.translation()),
                     to_bullet(to_com), true);
    }
    body_.finalizeMultiDof();
    body_.setBaseVel(btVector3(0.0, 0.0, 0.0));
    body_.setBaseOmega(btVector3(0.0, 0.0, 0.0));
  }

  void forward_dynamics(const Eigen::VectorXd& q, const Eigen::VectorXd& dq,
                        const Eigen::VectorXd& tau, Eigen::VectorXd& ddq) {
    body_.clearForcesAndTorques();
    for (int i = 0; i < body_.getNumLinks(); ++i) {
      body_.setJointPos(i, q[i]);
      body_.setJointVel(i, dq[i]);
      body_.addJointTorque(i, tau[i]);
      body_.addLinkForce(i, gravity_ * body_.getLinkMass(i));
    }
    // The velocities stay with a step of 0; the accelerations are left behind the base's six.
    body_.computeAccelerationsArticulatedBodyAlgorithmMultiDof(0.0, scalars_, vectors_, matrices_,
                                                               false, false, false);
    const int first = body_.getNumDofs() + 6;
    ddq.resize(body_.getNumLinks());
    for (int i = 0; i < body_.getNumLinks(); ++i) ddq[i] = scalars_[first + i];
  }

 private:
  btVector3 gravity_;
  btMultiBody body_;
  btAlignedObjectArray<btScalar> scalars_;
  btAlignedObjectArray<btVector3> vectors_;
  btAlignedObjectArray<btMatrix3x3> matrices_;
};

}  // namespace pcavr::test
