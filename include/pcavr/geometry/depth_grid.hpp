// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/geometry/camera.hpp"
#include "pcavr/geometry/image.hpp"

/// Depth images that are smaller than the colour images they are registered to. Both show the same
/// rectangle of the view: with k = colour width / depth width = colour height / depth height, the
/// colour pixel u lies at (u + 0.5) / k - 0.5 in the depth image. Where both have one size, all of
/// this is the identity. Plain functions; any thread may call them.
namespace pcavr {

/// Whether an image of this size may be a depth image of the camera: as large, or smaller by one
/// factor in width and height.
[[nodiscard]] bool is_depth_grid(const CameraModel& color, int width, int height);

/// The same camera on a grid of `width` x `height`, for which is_depth_grid must hold.
[[nodiscard]] CameraModel on_grid(const CameraModel& color, int width, int height);

/// Where a pixel of the grid of `from` lies on the grid of `to`.
[[nodiscard]] Eigen::Vector2d to_grid(const Eigen::Vector2d& pixel, const CameraModel& from,
                                      const CameraModel& to);

/// The picture on the depth image's coarser grid: each pixel the mean over its square, rounded.
/// The size must divide as is_depth_grid says. The same bytes as `color` where both are one size.
[[nodiscard]] ColorImage color_on_grid(const ColorImage& color, int width, int height);

/// Each pixel the depth image's nearest one; `width` and `height` are the colour's.
[[nodiscard]] DepthImage depth_on_color(DepthImage depth, int width, int height);

}  // namespace pcavr
