// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace pcavr::detail {

/// One point at which a body leans on a neighbour that is not the tip: another body, or what stands
/// still. Horizontal, base axes.
struct SideContact {
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();  ///< into the body
  Eigen::Vector2d arm = Eigen::Vector2d::Zero();      ///< from the body's centre of mass [m]
  double depth = 0.0;                                 ///< at the step's begin [m]; negative: a gap
  double closing = 0.0;  ///< how fast it deepened at the step's begin [m/s]
  Eigen::Vector2d neighbour_way = Eigen::Vector2d::Zero();  ///< of its point in the step [m]
  double stiffness = 0.0;                                   ///< [N/m]
  double damping = 0.0;                                     ///< [N s/m]
};

/// A force at the contact, and how it falls as the body's point moves.
struct SideForce {
  Eigen::Vector2d force = Eigen::Vector2d::Zero();      ///< on the body [N]
  Eigen::Matrix2d stiffness = Eigen::Matrix2d::Zero();  ///< [N/m]
};

/// Two solid bodies do not sink into each other; what was set so far into another one is pushed out
/// at 50 mm/s and no faster, so that it does not jump. Beside it Coulomb's friction. `slip` is the
/// way of the neighbour's point against the body's in `time` [s].
[[nodiscard]] SideForce side_force(const SideContact& contact, const Eigen::Vector2d& slip,
                                   double time) noexcept;

}  // namespace pcavr::detail
