// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "pcavr/physics/friction/limit_surface.hpp"

namespace pcavr {

/// Quasi-static pushing: a finger pushes a body so slowly that inertia is negligible [Mason 1986;
/// Lynch & Mason 1996].
/// Axes: those of the limit surface, fixed to the body. Nothing here allocates or throws.
struct PointPush {
  Eigen::Vector2d point = Eigen::Vector2d::Zero();     ///< of contact [m]
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();   ///< into the body; any length
  double friction_coefficient = 0.0;                   ///< between finger and body, >= 0
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  ///< of the finger [m/s]
};

enum class PushMode {
  separating,  ///< the finger does not press: the body stays at rest
  sticking,    ///< the point of the body moves with the finger
  slipping,    ///< the finger slips along the edge; the force is on an edge of the friction cone
};

struct PushMotion {
  PushMode mode = PushMode::separating;
  Eigen::Vector3d twist = Eigen::Vector3d::Zero();   ///< of the body
  Eigen::Vector3d wrench = Eigen::Vector3d::Zero();  ///< of the finger on the body, on the surface
};

/// The body's motion. One bisection for any convex surface: as the contact force rotates from one
/// edge of its friction cone to the other, the point's velocity rotates in the same direction,
/// because it is the gradient of a convex function of that force.
[[nodiscard]] PushMotion push_at_point(const LimitSurface& surface, const PointPush& push) noexcept;

/// The wrench of a force [N] at a point [m].
[[nodiscard]] Eigen::Vector3d wrench_of(const Eigen::Vector2d& force,
                                        const Eigen::Vector2d& point) noexcept;

/// The velocity of the body's point under a twist.
[[nodiscard]] Eigen::Vector2d velocity_of(const Eigen::Vector2d& point,
                                          const Eigen::Vector3d& twist) noexcept;

}  // namespace pcavr
