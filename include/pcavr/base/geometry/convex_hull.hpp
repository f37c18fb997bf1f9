// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

namespace pcavr {

/// The vertices of the 2D convex hull of the points projected onto the x-y plane (monotone chain):
/// counter-clockwise, without collinear points. Fewer than three where all points are collinear.
[[nodiscard]] std::vector<Eigen::Vector3d> convex_hull_xy(std::vector<Eigen::Vector3d> points);

/// Orientation test in the x-y plane: twice the signed area of the triangle, positive where a, b, c
/// are counter-clockwise.
[[nodiscard]] inline double orientation_xy(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                           const Eigen::Vector3d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

}  // namespace pcavr
