// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <Eigen/Core>

namespace pcavr::detail {

/// What a triangle forbids a ball: its centre stays where normal . (x - x0) >= -slack. The
/// triangle, being convex, lies wholly behind the plane through its point nearest to x0, so this
/// half-space is free of it however far the ball goes.
struct HalfSpace {
  Eigen::Vector3d normal;  ///< unit length, from the triangle to the ball
  double slack = 0.0;      ///< [m] >= 0, how far the ball is from touching
};

/// Touching: nearer than this [m]. A thousandth of an atom's size would do; rounding asks for more.
inline constexpr double kTouching = 1e-10;

/// The direction in which `wish` can be followed where all `half_spaces` that touch are kept: its
/// projection on their cone, zero where it has none or where too many touch.
[[nodiscard]] Eigen::Vector3d allowed(const Eigen::Vector3d& wish,
                                      std::span<const HalfSpace> half_spaces) noexcept;

/// Goes from `from` towards the point nearest to `goal` of what the half-spaces leave, on a path of
/// at most `budget` [m], and reduces both their slacks and the budget by what was gone. Every point
/// of the path is allowed.
[[nodiscard]] Eigen::Vector3d walk(const Eigen::Vector3d& from, const Eigen::Vector3d& goal,
                                   std::span<HalfSpace> half_spaces, double& budget) noexcept;

}  // namespace pcavr::detail
