// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace pcavr::model {

/// The corners of one triangle, counter-clockwise seen from outside [m].
struct Triangle {
  Eigen::Vector3d a;
  Eigen::Vector3d b;
  Eigen::Vector3d c;

  /// Normal scaled by twice the triangle's area.
  [[nodiscard]] Eigen::Vector3d doubled_area_normal() const { return (b - a).cross(c - a); }
};

/// The point of a triangle closest to `point`: its projection if that lies inside, else the closest
/// point on the edges. A degenerate triangle is treated as its edges.
[[nodiscard]] Eigen::Vector3d closest_point(const Triangle& triangle, const Eigen::Vector3d& point);

}  // namespace pcavr::model
