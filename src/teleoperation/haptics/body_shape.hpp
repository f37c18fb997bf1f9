// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "pcavr/physics/prediction/closest_surface.hpp"
#include "pcavr/physics/prediction/predicted_world.hpp"

namespace pcavr::detail {

/// A body's geometry for haptics, in the object's frame.
struct BodyShape {
  ClosestSurface surface;
  Eigen::Vector3d centre_of_mass;
  Eigen::Vector3d bounding_centre;  ///< of its bounding sphere
  double bounding_radius = 0.0;     ///< [m]
  double bottom = 0.0;              ///< [m] height of its lowest point in base
  double gyration_radius = 0.0;     ///< [m] about level axes, as of its bounding box
  double min_thickness = 0.0;       ///< [m]
};

[[nodiscard]] BodyShape shape_of(const WorldBody& body);

}  // namespace pcavr::detail
