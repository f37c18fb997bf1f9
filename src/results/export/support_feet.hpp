// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "pcavr/physics/friction/limit_surface.hpp"
#include "pcavr/results/export/exported_world.hpp"

namespace pcavr::detail {

/// A foot in the body's planar axes (heading_of), about its centre of mass.
struct PlanarFoot {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< [m]
  double friction = 1.0;                               ///< over the mean of all feet
};

inline constexpr int kFeet = 8;  ///< fewer make the torque depend on the direction by over 10 %

/// Feet on a circle about the centre of mass, which bear equal shares of the weight. Its radius is
/// the surface's maximum moment over its force: engines with soft contacts load the feet that slide
/// faster, and on a circle all are equally fast in a turn. Their coefficients differ so that the
/// friction's centre is the surface's.
[[nodiscard]] std::vector<PlanarFoot> fit_feet(const LimitSurface& surface);

/// Error of the feet against the surface over all twists: rms and maximum distance of the wrenches,
/// moments divided by the friction radius, over the force.
struct FeetError {
  double rms = 0.0;
  double max = 0.0;
};
[[nodiscard]] FeetError error_of(const std::vector<PlanarFoot>& feet, const LimitSurface& surface);

/// [m] Moment of a pure rotation about the centre of mass over the mean force.
[[nodiscard]] double turning_radius_of(const LimitSurface& surface);
[[nodiscard]] double turning_radius_of(const std::vector<PlanarFoot>& feet);

}  // namespace pcavr::detail
