// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "pcavr/robots/robot/robot_model.hpp"

#include "robots/robot/spatial.hpp"

namespace pcavr::robot {

/// Constants of a movable joint and its body, in "body axes": origin of the joint frame, z along
/// the joint's axis, and turned about z such that the rotation from the body to the first body that
/// it carries is Rx(twist) Rz(angle), as in Denavit and Hartenberg's notation. (The origin stays
/// where the description has it: on the common normal it would be far away for axes that are nearly
/// parallel.) Further bodies on the same parent need Rz(branch) Rx(twist) Rz(angle).
struct Body {
  static constexpr int kBase = -1;

  int parent = kBase;
  bool is_prismatic = false;
  bool is_branch = false;
  Turn branch;
  Turn twist;
  double angle_offset = 0.0;  ///< of Rz at position 0 [rad]
  Vec origin;                 ///< at position 0, in the parent's body axes [m]
  Vec slide;                  ///< a prismatic joint's axis, in the parent's body axes

  double mass = 0.0;
  Vec first_moment;    ///< mass * centre of mass
  Sym inertia;         ///< about the origin
  Sym pseudo_inertia;  ///< sum of m r r^T: half the trace of the inertia minus the inertia
  double armature = 0.0;

  std::size_t coordinate = 0;
  double multiplier = 1.0;
  double offset = 0.0;

  Eigen::Matrix3d R_joint_body;  ///< constant: from body axes to the joint frame of the model
};

/// A link in the body axes of its body (kBase: in the axes of BodyTree::R_base_body).
struct LinkPlace {
  int body = Body::kBase;
  Eigen::Matrix3d R_body_link;
  Eigen::Vector3d p_body_link;
};

struct BodyTree {
  std::vector<Body> bodies;  ///< as RobotModel::joints
  std::vector<LinkPlace> links;
  std::size_t dof = 0;
  bool has_mimic = false;
  Eigen::Matrix3d R_base_body;  ///< of the base's own body axes
  Vec minus_gravity;            ///< in the base's body axes [m/s^2]
};

[[nodiscard]] BodyTree make_body_tree(const RobotModel& model);

}  // namespace pcavr::robot
