// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pcavr/base/geometry/mesh.hpp"

namespace pcavr {

/// Convex hull of the points projected onto a plane that is not vertical: counter-clockwise from
/// above, without corners that protrude less than 2 mm.
[[nodiscard]] std::vector<Eigen::Vector3d> convex_outline(
    const std::vector<Eigen::Vector3d>& points, const Plane& plane);

/// Whether a point lies vertically above (or below) the inside of an outline.
[[nodiscard]] bool is_above_outline(const std::vector<Eigen::Vector3d>& outline,
                                    const Eigen::Vector3d& point);

}  // namespace pcavr
