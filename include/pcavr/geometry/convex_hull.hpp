// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

namespace pcavr {

/// The points on the convex hull as it is seen from above (along z): counter-clockwise, points on
/// an edge left out. Fewer than three where they lie on a line.
[[nodiscard]] std::vector<Eigen::Vector3d> convex_hull_from_above(
    std::vector<Eigen::Vector3d> points);

/// Twice the area of the triangle as seen from above; positive where the corners turn left.
[[nodiscard]] inline double turn_from_above(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                            const Eigen::Vector3d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

}  // namespace pcavr
