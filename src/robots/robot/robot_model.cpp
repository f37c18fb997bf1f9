// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot/robot_model.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/solvers.hpp"

namespace pcavr {
namespace {

Eigen::Matrix3d inertia_at_origin(const RigidInertia& inertia) {
  const Eigen::Matrix3d S = skew(inertia.centre_of_mass);
  return inertia.inertia_at_com - inertia.mass * S * S;
}

}  // namespace

RigidInertia transform(const Pose& T_a_b, const RigidInertia& inertia_b) {
  const Eigen::Matrix3d R_a_b = T_a_b.rotation_matrix();
  return {inertia_b.mass, T_a_b * inertia_b.centre_of_mass,
          R_a_b * inertia_b.inertia_at_com * R_a_b.transpose()};
}

RigidInertia operator+(const RigidInertia& a, const RigidInertia& b) {
  RigidInertia sum;
  sum.mass = a.mass + b.mass;
  if (sum.mass == 0.0) {
    sum.inertia_at_com = a.inertia_at_com + b.inertia_at_com;
    return sum;
  }
  sum.centre_of_mass = (a.mass * a.centre_of_mass + b.mass * b.centre_of_mass) / sum.mass;
  // The inertia is summed about the common centre, not the origin: no digits are lost far from it.
  for (const RigidInertia* part : {&a, &b}) {
    const Eigen::Matrix3d S = skew(part->centre_of_mass - sum.centre_of_mass);
    sum.inertia_at_com += part->inertia_at_com - part->mass * S * S;
  }
  return sum;
}

std::optional<std::string> physical_fault(const RigidInertia& inertia) {
  if (!(std::isfinite(inertia.mass) && inertia.centre_of_mass.allFinite() &&
        inertia.inertia_at_com.allFinite())) {
    return "is not finite";
  }
  if (inertia.mass <= 0.0) return fmt::format("mass {:g} kg is not positive", inertia.mass);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(inertia.inertia_at_com,
                                                              Eigen::EigenvaluesOnly);
  const Eigen::Vector3d& principal = solver.eigenvalues();
  // Descriptions round to some six digits.
  const double tolerance = 1e-6 * std::abs(principal[2]);
  if (principal[0] < -tolerance) {
    return fmt::format(
        "inertia is not positive definite: principal moments {:.4g}, {:.4g}, {:.4g} kg m^2",
        principal[0], principal[1], principal[2]);
  }
  if (principal[0] + principal[1] < principal[2] - tolerance) {
    return fmt::format(
        "inertia violates the triangle inequality: principal moments {:.4g} + {:.4g} < "
        "{:.4g} kg m^2",
        principal[0], principal[1], principal[2]);
  }
  return std::nullopt;
}

std::optional<std::size_t> RobotModel::joint_index(std::string_view joint_name) const {
  const auto found = std::find_if(joints.begin(), joints.end(), [&](const RobotJoint& joint) {
    return joint.name == joint_name;
  });
  if (found == joints.end()) return std::nullopt;
  return static_cast<std::size_t>(found - joints.begin());
}

std::optional<std::size_t> RobotModel::link_index(std::string_view link_name) const {
  const auto found = std::find_if(links.begin(), links.end(),
                                  [&](const RobotLink& link) { return link.name == link_name; });
  if (found == links.end()) return std::nullopt;
  return static_cast<std::size_t>(found - links.begin());
}

std::vector<std::size_t> RobotModel::coordinate_joints() const {
  std::vector<std::size_t> leaders(dof);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (!joints[i].mimics) leaders[joints[i].coordinate] = i;
  }
  return leaders;
}

bool RobotModel::has_inertia() const {
  std::vector<bool> has_mass(joints.size());
  for (std::size_t i = joints.size(); i-- > 0;) {
    const RobotJoint& joint = joints[i];
    has_mass[i] = has_mass[i] || joint.body.mass > 0.0 || joint.armature > 0.0;
    if (!has_mass[i]) return false;
    if (joint.parent && joint.body.mass > 0.0) has_mass[*joint.parent] = true;
  }
  return true;
}

namespace {

Pose motion_of(const RobotJoint& joint, double position) {
  if (joint.kind == JointKind::kPrismatic) {
    return Pose::from_translation(position * joint.axis);
  }
  return {Eigen::Quaterniond(Eigen::AngleAxisd(position, joint.axis)), Eigen::Vector3d::Zero()};
}

/// The position at which each joint is locked; nothing for those that stay movable.
std::vector<std::optional<double>> locked_positions(const RobotModel& model,
                                                    const std::vector<LockedJoint>& locked) {
  std::vector<std::optional<double>> by_coordinate(model.dof);
  for (const LockedJoint& lock : locked) {
    const std::optional<std::size_t> index = model.joint_index(lock.name);
    PCAVR_REQUIRE(index.has_value() && !model.joints[*index].mimics, lock.name);
    PCAVR_REQUIRE(std::isfinite(lock.position), lock.name, lock.position);
    by_coordinate[model.joints[*index].coordinate] = lock.position;
  }
  std::vector<std::optional<double>> positions;
  for (const RobotJoint& joint : model.joints) {
    const std::optional<double> q = by_coordinate[joint.coordinate];
    positions.push_back(q ? std::optional(joint.multiplier * *q + joint.offset) : std::nullopt);
  }
  return positions;
}

/// Place in the new model of the frame of a joint of the old one: the joint that carries it, and
/// the pose.
struct CarriedFrame {
  std::optional<std::size_t> joint;
  Pose T_carrier_frame;
};

}  // namespace

RobotModel lock_joints(const RobotModel& model, const std::vector<LockedJoint>& locked) {
  const std::vector<std::optional<double>> positions = locked_positions(model, locked);
  RobotModel reduced = model;
  reduced.joints.clear();
  std::vector<CarriedFrame> frames;
  std::vector<std::optional<std::size_t>> coordinates(model.dof);
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    RobotJoint joint = model.joints[i];
    const CarriedFrame parent = joint.parent ? frames[*joint.parent] : CarriedFrame{};
    const Pose T_carrier_joint = parent.T_carrier_frame * joint.T_parent_joint;
    if (positions[i]) {
      const CarriedFrame frame{parent.joint, T_carrier_joint * motion_of(joint, *positions[i])};
      if (parent.joint) {
        RigidInertia& body = reduced.joints[*parent.joint].body;
        body = body + transform(frame.T_carrier_frame, joint.body);
      }
      frames.push_back(frame);
      continue;
    }
    joint.parent = parent.joint;
    joint.T_parent_joint = T_carrier_joint;
    frames.push_back({reduced.joints.size(), {}});
    reduced.joints.push_back(joint);
  }
  // Coordinates keep their order.
  reduced.dof = 0;
  for (const std::size_t leader : model.coordinate_joints()) {
    if (!positions[leader]) coordinates[model.joints[leader].coordinate] = reduced.dof++;
  }
  for (RobotJoint& joint : reduced.joints) joint.coordinate = coordinates[joint.coordinate].value();
  for (RobotLink& link : reduced.links) {
    if (!link.joint) continue;
    const CarriedFrame& frame = frames[*link.joint];
    link.joint = frame.joint;
    link.T_joint_link = frame.T_carrier_frame * link.T_joint_link;
  }
  return reduced;
}

Eigen::VectorXd inertial_parameters(const RobotModel& model) {
  Eigen::VectorXd parameters(static_cast<Eigen::Index>(10 * model.joints.size()));
  Eigen::Index at = 0;
  for (const RobotJoint& joint : model.joints) {
    const Eigen::Matrix3d I = inertia_at_origin(joint.body);
    const Eigen::Vector3d h = joint.body.mass * joint.body.centre_of_mass;
    parameters.segment<10>(at) << joint.body.mass, h, I(0, 0), I(0, 1), I(0, 2), I(1, 1), I(1, 2),
        I(2, 2);
    at += 10;
  }
  return parameters;
}

RobotModel with_inertial_parameters(const RobotModel& model, const Eigen::VectorXd& parameters) {
  PCAVR_REQUIRE(static_cast<std::size_t>(parameters.size()) == 10 * model.joints.size(),
                parameters.size(), model.joints.size());
  PCAVR_REQUIRE(parameters.allFinite());
  RobotModel changed = model;
  for (std::size_t i = 0; i < changed.joints.size(); ++i) {
    const Eigen::Matrix<double, 10, 1> p =
        parameters.segment<10>(static_cast<Eigen::Index>(10 * i));
    RigidInertia& body = changed.joints[i].body;
    body.mass = p[0];
    const bool has_moment = !p.segment<3>(1).isZero(0.0);
    PCAVR_REQUIRE(body.mass != 0.0 || !has_moment, changed.joints[i].name);
    body.centre_of_mass =
        has_moment ? Eigen::Vector3d(p.segment<3>(1) / body.mass) : Eigen::Vector3d::Zero();
    body.inertia_at_com << p[4], p[5], p[6], p[5], p[7], p[8], p[6], p[8], p[9];
    const Eigen::Matrix3d S = skew(body.centre_of_mass);
    body.inertia_at_com += body.mass * S * S;
  }
  return changed;
}

}  // namespace pcavr
