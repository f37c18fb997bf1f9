// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>

#include <Eigen/Core>

namespace pcavr {

/// The mean distance of the support pressure from a centre [m]: the integral of pressure times |r|
/// over the contact patch, over the integral of pressure. With the maximum friction force F [N],
/// the maximum moment about that centre is F times this [Goyal et al. 1991]. Nothing here
/// allocates.

/// The mean radius of a simple polygon under uniform pressure, its corners in either order; 0 where
/// it has no area.
[[nodiscard]] double mean_radius(std::span<const Eigen::Vector2d> polygon,
                                 const Eigen::Vector2d& centre) noexcept;

/// The mean radius of a rectangle with the sides given [m], about its middle.
[[nodiscard]] double mean_radius_of_rectangle(double length, double width) noexcept;

/// The shares of the weight that three points bear, their sum 1. Empty where the points lie on a
/// line, or the centre of mass outside of the support triangle: the body would tip.
[[nodiscard]] std::optional<std::array<double, 3>> support_shares(
    const std::array<Eigen::Vector2d, 3>& points, const Eigen::Vector2d& centre_of_mass) noexcept;

/// The mean radius of three points that bear the given shares of the weight.
[[nodiscard]] double mean_radius(const std::array<Eigen::Vector2d, 3>& points,
                                 const std::array<double, 3>& shares,
                                 const Eigen::Vector2d& centre) noexcept;

}  // namespace pcavr
