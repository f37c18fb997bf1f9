// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace pcavr::detail {

/// The goal of a proxy at `centre` under Coulomb friction: the tip, less what the friction cone
/// absorbs of the tangential pull. The tip pulls by a spring, so that the force's cone is a cone of
/// lengths. `normal` zero: no contact.
inline Eigen::Vector3d friction_limited_goal(const Eigen::Vector3d& tip,
                                             const Eigen::Vector3d& centre,
                                             const Eigen::Vector3d& normal,
                                             double friction) noexcept {
  const Eigen::Vector3d pull = tip - centre;
  const double penetration = -pull.dot(normal);
  if (normal.isZero(0.0) || penetration <= 0.0) return tip;
  const Eigen::Vector3d tangential = pull + penetration * normal;
  const double length = tangential.norm();
  const double static_limit = friction * penetration;
  return length <= static_limit ? Eigen::Vector3d(tip - tangential)
                                : Eigen::Vector3d(tip - static_limit / length * tangential);
}

}  // namespace pcavr::detail
