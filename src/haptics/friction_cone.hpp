// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace pcavr::detail {

/// Where a ball at `centre` would go: below the tip by as much as friction lets it lag behind. The
/// tip pulls by a spring, so the cone of the force is a cone of lengths. `normal` zero: no contact.
inline Eigen::Vector3d held_back(const Eigen::Vector3d& tip, const Eigen::Vector3d& centre,
                                 const Eigen::Vector3d& normal, double friction) noexcept {
  const Eigen::Vector3d pull = tip - centre;
  const double depth = -pull.dot(normal);
  if (normal.isZero(0.0) || depth <= 0.0) return tip;
  const Eigen::Vector3d along = pull + depth * normal;
  const double length = along.norm();
  const double held = friction * depth;
  return length <= held ? Eigen::Vector3d(tip - along)
                        : Eigen::Vector3d(tip - held / length * along);
}

}  // namespace pcavr::detail
