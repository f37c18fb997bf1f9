// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "pcavr/geometry/pose.hpp"

namespace pcavr {

/// The poses T_camera_marker that explain the four corners of a square tag of `size` [m] to first
/// order at its centre: two, mirrored about the line of sight, fewer where the corners are no
/// convex quadrilateral seen from its front [Collins & Bartoli 2014, IPPE]. Corners are given on
/// the plane z = 1 of the undistorted camera, in the order of TagDetection::corners.
[[nodiscard]] std::vector<Pose> planar_poses(const std::array<Eigen::Vector2d, 4>& corners,
                                             double size);

}  // namespace pcavr
