// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pcavr/physics/identification/path_view.hpp"

#include "physics/inputs/body_poses.hpp"

namespace pcavr {

inline constexpr double kDegree = std::numbers::pi / 180.0;  // [rad]

/// The direction of one contact's force beside the one that it must have. The point of an object
/// that slides at which its support's pressure is centred moves along the force, whatever the
/// friction at the tip; one that rests is pushed along the face's normal, within the friction at
/// the tip.
struct ForceDirection {
  Eigen::Vector3d force_base = Eigen::Vector3d::UnitX();     ///< unit
  Eigen::Vector3d expected_base = Eigen::Vector3d::UnitX();  ///< unit
  double across_std =
      0.0;  ///< [rad] of the expected one, in the plane; of a press in any direction
  double upward_std = 0.0;  ///< [rad] out of the plane
  /// The error is friction at the tip, which may be the same in all contacts with one face.
  bool is_by_face = false;
  std::optional<Eigen::Quaterniond> q_base_tool = {};  ///< where it is known
};

/// Direction of one contact's force while it is loaded and the object is pushed, as sums from which
/// the same follows for any permutation of the axes.
struct ContactEvidence {
  std::size_t contact = 0;                                 ///< index
  Eigen::Vector3d force_base = Eigen::Vector3d::Zero();    ///< [N] sum, bias removed
  Eigen::Vector3d inward_base = Eigen::Vector3d::Zero();   ///< unit, from the tip to the surface
  Eigen::Matrix3d force_motion = Eigen::Matrix3d::Zero();  ///< [N m] sum of F dx'
  double effort = 0.0;                                     ///< [N m] sum of |F| |dx|
  // These are as if the force were recorded in the tool's axes; only where the tool's orientation
  // is known.
  Eigen::Vector3d tool_force_base = Eigen::Vector3d::Zero();
  double tool_work = 0.0;                        ///< [N m]
  std::optional<ForceDirection> direction = {};  ///< of a contact that can be used
};

/// The agreement of the force with the surfaces touched and with the tool's motion.
struct DirectionAgreement {
  double inward = 0.0;  ///< mean cosine between force and the direction into the body, by contact
  double motion =
      0.0;  ///< work over effort, -1 to 1: positive, because a pushed object dissipates work
};

/// The evidence of the contacts that are attributed to an object.
[[nodiscard]] std::vector<ContactEvidence> gather_evidence(const InputSeries& series,
                                                           std::span<const Contact> contacts,
                                                           const PathView& tip,
                                                           const BodyPoses& poses);

/// `axes` maps the recorded force to base.
[[nodiscard]] DirectionAgreement agreement_of(std::span<const ContactEvidence> evidence,
                                              const Eigen::Matrix3d& axes);
[[nodiscard]] DirectionAgreement agreement_in_tool_axes(std::span<const ContactEvidence> evidence);

/// Cosine between the force and the direction into the body.
[[nodiscard]] double inward_cosine(const ContactEvidence& evidence);

/// Apparent friction coefficient: median of horizontal force over the normal force on the support,
/// while the object moves by more than 2 mm in one contact; nothing for less. A body that was not
/// weighed has the mass of wood of its volume.
[[nodiscard]] std::optional<double> friction_ratio(const InputSeries& series,
                                                   const Contact& contact, const BodyPoses& poses);

}  // namespace pcavr
