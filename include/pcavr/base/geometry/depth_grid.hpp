// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/image.hpp"

/// Registered depth images of a lower resolution than their colour images. Both have the same
/// field of view: with k = colour width / depth width = colour height / depth height, the
/// colour pixel u lies at (u + 0.5) / k - 0.5 in the depth image. At the same size, all
/// functions are the identity. Thread-safe.
namespace pcavr {

/// Whether an image of this size may be a depth image of the camera: the same size, or smaller by
/// the same factor in width and height.
[[nodiscard]] bool is_depth_grid(const CameraModel& color, int width, int height);

/// The camera with its intrinsics rescaled to `width` x `height`; is_depth_grid must hold.
[[nodiscard]] CameraModel on_grid(const CameraModel& color, int width, int height);

/// A pixel of the image of `from`, in pixels of the image of `to`.
[[nodiscard]] Eigen::Vector2d to_grid(const Eigen::Vector2d& pixel, const CameraModel& from,
                                      const CameraModel& to);

/// The colour image downsampled to the depth image's size by area averaging, rounded;
/// is_depth_grid must hold. The same bytes as `color` at the same size.
[[nodiscard]] ColorImage color_on_grid(const ColorImage& color, int width, int height);

/// The depth image upsampled to the colour image's `width` and `height` by nearest neighbour.
[[nodiscard]] DepthImage depth_on_color(DepthImage depth, int width, int height);

}  // namespace pcavr
