// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/pose.hpp"

namespace pcavr {

/// The two solutions T_camera_marker of the planar (two-fold) pose ambiguity of a square tag of
/// `size` [m], by IPPE [Collins & Bartoli 2014]: the poses that match the homography to first order
/// at its centre. Fewer if the corners are not a convex quadrilateral seen from its front. Corners
/// are given on the plane z = 1 of the undistorted camera, in the order of TagDetection::corners.
[[nodiscard]] std::vector<Pose> planar_poses(const std::array<Eigen::Vector2d, 4>& corners,
                                             double size);

}  // namespace pcavr
