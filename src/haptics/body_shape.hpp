// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "pcavr/prediction/predicted_world.hpp"

#include "prediction/closest_surface.hpp"

namespace pcavr::detail {

/// What a tool has to know of a body, in the object's frame.
struct BodyShape {
  ClosestSurface surface;
  Eigen::Vector3d centre_of_mass;
  Eigen::Vector3d middle;        ///< of a ball around it all
  double reach = 0.0;            ///< [m] that ball's radius
  double foot = 0.0;             ///< [m] the height of its lowest point in base
  double gyration_radius = 0.0;  ///< [m] about level axes, as of its bounding box
  double thinnest = 0.0;         ///< [m]
};

[[nodiscard]] BodyShape shape_of(const WorldBody& body);

}  // namespace pcavr::detail
