// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/perception/board/board_views.hpp"

namespace pcavr {

/// The places on the board [m] of a view's points.
[[nodiscard]] std::vector<Eigen::Vector3d> points_of(const BoardView& view,
                                                     const std::vector<Eigen::Vector3d>& board);

/// T_camera_board by one picture: the better one of the two solutions for a plane [Collins &
/// Bartoli 2014], refined; nullopt where the points are on a line.
[[nodiscard]] std::optional<Pose> board_pose(const CameraModel& camera,
                                             const std::vector<Eigen::Vector3d>& points,
                                             const std::vector<Eigen::Vector2d>& pixels);

/// A camera without distortion for a start: the focal length by the board's vanishing points [Zhang
/// 2000], or of a usual lens where they do not show it.
[[nodiscard]] CameraModel first_camera(const BoardViews& views,
                                       const std::vector<Eigen::Vector3d>& board, LensModel lens);

}  // namespace pcavr
