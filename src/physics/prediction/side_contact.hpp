// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include <Eigen/Core>

namespace pcavr::detail {

/// One contact point of a body with a neighbour that is not the tip: another body, or the static
/// mesh. Horizontal, base axes.
struct SideContact {
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();  ///< into the body
  Eigen::Vector2d arm = Eigen::Vector2d::Zero();      ///< from the body's centre of mass [m]
  double depth = 0.0;                                 ///< at the step's begin [m]; negative: a gap
  double closing = 0.0;                               ///< closing speed at the step's begin [m/s]
  Eigen::Vector2d neighbour_displacement =
      Eigen::Vector2d::Zero();  ///< of its point in the step [m]
  double stiffness = 0.0;       ///< [N/m]
  double damping = 0.0;         ///< [N s/m]
  double friction = 0.0;        ///< Coulomb coefficient
  /// [m/s] > 0 at which an overlap is resolved.
  double max_separation_speed = std::numeric_limits<double>::infinity();
};

/// A force at the contact, and its decrease as the body's point moves.
struct SideForce {
  Eigen::Vector2d force = Eigen::Vector2d::Zero();      ///< on the body [N]
  Eigen::Matrix2d stiffness = Eigen::Matrix2d::Zero();  ///< [N/m]
};

/// Penalty force (spring and damper) with Coulomb friction. An overlap that was set from outside is
/// resolved at `max_separation_speed` and no faster, so that the body does not jump. `slip` is the
/// displacement of the neighbour's point relative to the body's in `time` [s].
[[nodiscard]] SideForce side_force(const SideContact& contact, const Eigen::Vector2d& slip,
                                   double time) noexcept;

}  // namespace pcavr::detail
