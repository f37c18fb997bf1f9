// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <Eigen/Core>

namespace pcavr::detail {

/// A triangle's linear constraint on the sphere's centre x: normal . (x - x0) >= -slack. The
/// triangle is convex and lies wholly behind the plane through its point nearest to x0, so that
/// this half-space is collision-free at any distance.
struct HalfSpace {
  Eigen::Vector3d normal;  ///< unit length, from the triangle to the sphere
  double slack = 0.0;      ///< [m] >= 0, gap to the sphere
};

/// [m] A constraint with less slack is active. Rounding needs this much.
inline constexpr double kContactSlack = 1e-10;

/// Projects `desired` on the cone that the active constraints among `half_spaces` allow; zero where
/// nothing is left or where too many are active.
[[nodiscard]] Eigen::Vector3d project_on_cone(const Eigen::Vector3d& desired,
                                              std::span<const HalfSpace> half_spaces) noexcept;

/// Moves from `from` towards the point nearest to `goal` within the half-spaces (an active-set
/// method: collide and slide), on a path of at most `budget` [m]; reduces their slacks and the
/// budget by the path. Every point of the path satisfies all constraints.
[[nodiscard]] Eigen::Vector3d move_constrained(const Eigen::Vector3d& from,
                                               const Eigen::Vector3d& goal,
                                               std::span<HalfSpace> half_spaces,
                                               double& budget) noexcept;

}  // namespace pcavr::detail
