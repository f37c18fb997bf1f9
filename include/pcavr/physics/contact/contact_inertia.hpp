// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include <Eigen/Core>

namespace pcavr {

/// The term m d'' of mass_damper_spring [paper C, eq. 2] beside the rest of the law, `force` [N]:
/// of material of `mass` [kg] that moves with a tip of acceleration `a_base_tip` [m/s^2], along
/// `force`. The sum of both never pulls. The body's own acceleration is neglected: a body with such
/// a contact is pressed, or slides slowly. Neither allocates nor throws; any thread.
[[nodiscard]] inline Eigen::Vector3d inertial_force(const Eigen::Vector3d& a_base_tip,
                                                    const Eigen::Vector3d& force,
                                                    double mass) noexcept {
  const double magnitude = force.norm();
  if (!(mass > 0.0) || !(magnitude > 0.0)) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d along = force / magnitude;
  return std::max(-magnitude, mass * a_base_tip.dot(along)) * along;
}

}  // namespace pcavr
