// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot/robot_dynamics.hpp"

#include "pcavr/base/core/check.hpp"

#include "robots/robot/workspace.hpp"

namespace pcavr {

using robot::Body;
using robot::Vec;

struct RobotDynamics::Workspace : robot::Workspace {
  using robot::Workspace::Workspace;
};

namespace {

void require_size(Eigen::Index size, std::size_t dof) {
  PCAVR_REQUIRE(static_cast<std::size_t>(size) == dof, size, dof);
}

}  // namespace

RobotDynamics::RobotDynamics(const RobotModel& model)
    : workspace_(std::make_unique<Workspace>(robot::make_body_tree(model))) {}
RobotDynamics::RobotDynamics(const RobotDynamics& other)
    : workspace_(std::make_unique<Workspace>(*other.workspace_)) {}
RobotDynamics::RobotDynamics(RobotDynamics&& other) noexcept = default;
RobotDynamics& RobotDynamics::operator=(const RobotDynamics& other) {
  if (this != &other) workspace_ = std::make_unique<Workspace>(*other.workspace_);
  return *this;
}
RobotDynamics& RobotDynamics::operator=(RobotDynamics&& other) noexcept = default;
RobotDynamics::~RobotDynamics() = default;

std::size_t RobotDynamics::dof() const { return workspace_->tree.dof; }
std::size_t RobotDynamics::joints() const { return workspace_->tree.bodies.size(); }
std::size_t RobotDynamics::links() const { return workspace_->tree.links.size(); }

void RobotDynamics::forward_kinematics(const Vector& q) {
  require_size(q.size(), dof());
  workspace_->set_positions(q.data());
  workspace_->place_bodies();
}

Pose RobotDynamics::T_base_link(std::size_t link) const {
  PCAVR_REQUIRE(link < links(), link, links());
  const robot::Placement place = workspace_->place_of_link(link);
  return {Eigen::Quaterniond(place.rotation), place.translation};
}

void RobotDynamics::jacobian(const Vector& q, std::size_t link, Eigen::Ref<Matrix6Xd> jacobian,
                             const Eigen::Vector3d& p_link) {
  PCAVR_REQUIRE(link < links(), link, links());
  require_size(jacobian.cols(), dof());
  forward_kinematics(q);
  const robot::Placement place = workspace_->place_of_link(link);
  const Eigen::Vector3d point = place.rotation * p_link + place.translation;
  jacobian.setZero();
  const std::vector<Body>& bodies = workspace_->tree.bodies;
  for (int i = workspace_->tree.links[link].body; i != Body::kBase;
       i = bodies[static_cast<std::size_t>(i)].parent) {
    const Body& body = bodies[static_cast<std::size_t>(i)];
    const robot::Placement& joint = workspace_->places[static_cast<std::size_t>(i)];
    const Eigen::Vector3d axis = body.multiplier * joint.rotation.col(2);
    const auto column = static_cast<Eigen::Index>(body.coordinate);
    if (body.is_prismatic) {
      jacobian.col(column).head<3>() += axis;
    } else {
      jacobian.col(column).head<3>() += axis.cross(point - joint.translation);
      jacobian.col(column).tail<3>() += axis;
    }
  }
}

void RobotDynamics::inverse_dynamics(const Vector& q, const Vector& dq, const Vector& ddq,
                                     Eigen::Ref<Eigen::VectorXd> tau) {
  require_size(q.size(), dof());
  require_size(dq.size(), dof());
  require_size(ddq.size(), dof());
  require_size(tau.size(), dof());
  workspace_->set_positions(q.data());
  workspace_->inverse_dynamics(dq.data(), ddq.data(), tau.data());
}

void RobotDynamics::gravity_torque(const Vector& q, Eigen::Ref<Eigen::VectorXd> tau) {
  require_size(q.size(), dof());
  require_size(tau.size(), dof());
  workspace_->set_positions(q.data());
  workspace_->gravity_torque(tau.data());
}

void RobotDynamics::forward_dynamics(const Vector& q, const Vector& dq, const Vector& tau,
                                     Eigen::Ref<Eigen::VectorXd> ddq) {
  require_size(q.size(), dof());
  require_size(dq.size(), dof());
  require_size(tau.size(), dof());
  require_size(ddq.size(), dof());
  workspace_->set_positions(q.data());
  if (workspace_->tree.has_mimic) {
    workspace_->solve_with_mass_matrix(dq.data(), tau.data(), ddq.data());
  } else {
    workspace_->forward_dynamics(dq.data(), tau.data(), ddq.data());
  }
}

void RobotDynamics::mass_matrix(const Vector& q, Eigen::Ref<Eigen::MatrixXd> mass) {
  require_size(q.size(), dof());
  require_size(mass.rows(), dof());
  require_size(mass.cols(), dof());
  workspace_->set_positions(q.data());
  workspace_->fill_mass_matrix();
  mass = workspace_->mass;
}

void RobotDynamics::regressor(const Vector& q, const Vector& dq, const Vector& ddq,
                              Eigen::Ref<Eigen::MatrixXd> regressor) {
  require_size(q.size(), dof());
  require_size(dq.size(), dof());
  require_size(ddq.size(), dof());
  require_size(regressor.rows(), dof());
  require_size(regressor.cols(), 10 * joints());
  workspace_->set_positions(q.data());
  workspace_->fill_regressor(dq.data(), ddq.data(), regressor);
}

double RobotDynamics::kinetic_energy(const Vector& q, const Vector& dq) {
  require_size(q.size(), dof());
  require_size(dq.size(), dof());
  workspace_->set_positions(q.data());
  return workspace_->kinetic_energy(dq.data());
}

double RobotDynamics::potential_energy(const Vector& q) {
  require_size(q.size(), dof());
  workspace_->set_positions(q.data());
  workspace_->place_bodies();
  const robot::BodyTree& tree = workspace_->tree;
  double energy = 0.0;
  for (std::size_t i = 0; i < tree.bodies.size(); ++i) {
    const Body& body = tree.bodies[i];
    const robot::Placement& place = workspace_->places[i];
    const Eigen::Vector3d moment_base =
        body.mass * place.translation + place.rotation * to_eigen(body.first_moment);
    energy += (tree.R_base_body * to_eigen(tree.minus_gravity)).dot(moment_base);
  }
  return energy;
}

}  // namespace pcavr
