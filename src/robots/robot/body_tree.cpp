// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "robots/robot/body_tree.hpp"

#include <cmath>
#include <optional>

#include <Eigen/Geometry>

#include "pcavr/base/core/solvers.hpp"

namespace pcavr::robot {
namespace {

/// The smallest rotation that maps z to the axis; for the axes of a frame without rounding.
Eigen::Matrix3d rotation_from_z(const Eigen::Vector3d& axis) {
  for (int i = 0; i < 3; ++i) {
    if (std::abs(axis[i]) != 1.0) continue;
    // A cyclic permutation; for a negative axis two of the columns change sign.
    Eigen::Matrix3d permutation = Eigen::Matrix3d::Zero();
    permutation(i, 2) = axis[i];
    permutation((i + 1) % 3, 0) = axis[i];
    permutation((i + 2) % 3, 1) = 1.0;
    return permutation;
  }
  return Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), axis).toRotationMatrix();
}

Eigen::Matrix3d rotation_about_z(double angle) {
  return Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

/// Rotation = Rz(first) Rx(twist) Rz(last).
struct ZxzAngles {
  double first = 0.0;
  Turn twist;
  double last = 0.0;
};

ZxzAngles zxz_angles(const Eigen::Matrix3d& rotation) {
  ZxzAngles angles;
  const double sine = std::hypot(rotation(0, 2), rotation(1, 2));
  const double length = std::hypot(sine, rotation(2, 2));
  angles.twist = {rotation(2, 2) / length, sine / length};
  if (sine > 0.0) angles.first = std::atan2(rotation(0, 2), -rotation(1, 2));
  // The last angle is that of the remainder, so that the product is right where `first` is
  // arbitrary (parallel axes).
  Eigen::Matrix3d about_x;
  about_x << 1.0, 0.0, 0.0, 0.0, angles.twist.c, -angles.twist.s, 0.0, angles.twist.s,
      angles.twist.c;
  const Eigen::Matrix3d remainder =
      (rotation_about_z(angles.first) * about_x).transpose() * rotation;
  angles.last = std::atan2(remainder(1, 0), remainder(0, 0));
  return angles;
}

void set_inertia(Body& body, const RigidInertia& inertia_joint) {
  const Eigen::Matrix3d R_body_joint = body.R_joint_body.transpose();
  const Eigen::Vector3d centre = R_body_joint * inertia_joint.centre_of_mass;
  const Eigen::Matrix3d inertia = R_body_joint * inertia_joint.inertia_at_com * body.R_joint_body -
                                  inertia_joint.mass * skew(centre) * skew(centre);
  body.mass = inertia_joint.mass;
  body.first_moment = to_vec(inertia_joint.mass * centre);
  body.inertia = to_sym(inertia);
  body.pseudo_inertia = to_sym(0.5 * inertia.trace() * Eigen::Matrix3d::Identity() - inertia);
}

/// The frames of the bodies: a turn about each axis that the first child of each body chooses.
class FrameChoice {
 public:
  explicit FrameChoice(std::size_t bodies) : turns_(bodies + 1) {}

  /// The turn of a body's axes about its z; the base is body -1.
  [[nodiscard]] double turn(int body) const {
    return turns_[static_cast<std::size_t>(body) + 1].value_or(0.0);
  }
  /// The rest of `first` that the parent's turn does not cover.
  double take(int parent, double first) {
    std::optional<double>& chosen = turns_[static_cast<std::size_t>(parent) + 1];
    if (!chosen) chosen = first;
    return first - *chosen;
  }

 private:
  std::vector<std::optional<double>> turns_;
};

/// The axes of joint and parent before the turns about z.
struct JointPlace {
  Eigen::Matrix3d R_joint_axis;
  ZxzAngles angles;
};

std::vector<JointPlace> find_places(const RobotModel& model) {
  std::vector<JointPlace> places;
  for (const RobotJoint& joint : model.joints) {
    JointPlace place{rotation_from_z(joint.axis), {}};
    Eigen::Matrix3d R = joint.T_parent_joint.rotation_matrix() * place.R_joint_axis;
    if (joint.parent) R = places[*joint.parent].R_joint_axis.transpose() * R;
    place.angles = zxz_angles(R);
    places.push_back(place);
  }
  return places;
}

Body make_body(const RobotJoint& joint, const JointPlace& place, double own_turn,
               double branch_angle, const Eigen::Matrix3d& R_parent_body) {
  Body body;
  body.parent = joint.parent ? static_cast<int>(*joint.parent) : Body::kBase;
  body.is_prismatic = joint.kind == JointKind::kPrismatic;
  body.is_branch = branch_angle != 0.0;
  body.branch = {std::cos(branch_angle), std::sin(branch_angle)};
  body.twist = place.angles.twist;
  body.angle_offset = place.angles.last + own_turn;
  body.origin = to_vec(R_parent_body.transpose() * joint.T_parent_joint.translation());
  body.slide = about_z(body.branch, about_x(body.twist, Vec{0.0, 0.0, 1.0}));
  body.armature = joint.armature;
  body.coordinate = joint.coordinate;
  body.multiplier = joint.multiplier;
  body.offset = joint.offset;
  body.R_joint_body = place.R_joint_axis * rotation_about_z(own_turn);
  set_inertia(body, joint.body);
  return body;
}

}  // namespace

BodyTree make_body_tree(const RobotModel& model) {
  BodyTree tree;
  const std::vector<JointPlace> places = find_places(model);
  FrameChoice frames(model.joints.size());
  std::vector<double> branches;
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    const int parent = model.joints[i].parent ? static_cast<int>(*model.joints[i].parent) : -1;
    branches.push_back(frames.take(parent, places[i].angles.first));
  }
  tree.R_base_body = rotation_about_z(frames.turn(Body::kBase));
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    const RobotJoint& joint = model.joints[i];
    const Eigen::Matrix3d R_parent_body =
        joint.parent ? tree.bodies[*joint.parent].R_joint_body : tree.R_base_body;
    tree.bodies.push_back(
        make_body(joint, places[i], frames.turn(static_cast<int>(i)), branches[i], R_parent_body));
  }
  for (const RobotLink& link : model.links) {
    const Eigen::Matrix3d R_body_joint =
        (link.joint ? tree.bodies[*link.joint].R_joint_body : tree.R_base_body).transpose();
    tree.links.push_back({link.joint ? static_cast<int>(*link.joint) : Body::kBase,
                          R_body_joint * link.T_joint_link.rotation_matrix(),
                          R_body_joint * link.T_joint_link.translation()});
  }
  tree.dof = model.dof;
  tree.has_mimic = model.has_mimic_joints();
  tree.minus_gravity = to_vec(tree.R_base_body.transpose() * -model.gravity_base);
  return tree;
}

}  // namespace pcavr::robot
