// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pcavr/identification/path_view.hpp"

#include "inputs/body_poses.hpp"

namespace pcavr {

/// Direction of one contact's force while it is loaded and the object is pushed, as sums from which
/// the same follows for any permutation of the axes.
struct ContactEvidence {
  std::size_t contact = 0;                                 ///< index
  Eigen::Vector3d force_base = Eigen::Vector3d::Zero();    ///< [N] sum, bias removed
  Eigen::Vector3d inward_base = Eigen::Vector3d::Zero();   ///< unit, from the tip to the surface
  Eigen::Matrix3d force_motion = Eigen::Matrix3d::Zero();  ///< [N m] sum of F dx'
  double effort = 0.0;                                     ///< [N m] sum of |F| |dx|
  // As if the force were recorded in the tool's axes; only where the tool's orientation is known.
  Eigen::Vector3d tool_force_base = Eigen::Vector3d::Zero();
  double tool_work = 0.0;  ///< [N m]
};

/// How well the force agrees with the surfaces touched and with the tool's motion.
struct DirectionAgreement {
  double inward = 0.0;  ///< mean cosine between force and the direction into the body, by contact
  double motion =
      0.0;  ///< work over effort, -1 to 1: positive, because a pushed object dissipates work
};

/// For the contacts that are attributed to an object.
[[nodiscard]] std::vector<ContactEvidence> gather_evidence(
    const InputSeries& series, std::span<const AttributedContact> contacts, const PathView& tip,
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
                                                   const AttributedContact& contact,
                                                   const BodyPoses& poses);

}  // namespace pcavr
