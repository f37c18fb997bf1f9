// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/perception/marker/tag_detector.hpp"

namespace pcavr {

struct RefinedCorners {
  std::array<Eigen::Vector2d, 4> corners;  ///< [px]
  double corner_std = 0.0;                 ///< [px], of one coordinate, from the grey noise
};

/// Subpixel corner refinement: intersects the four fitted edges of a square. Each edge is modelled
/// as a step between a dark and a bright side, blurred by a Gaussian; line, both grey levels and
/// blur are fitted to the grey values of all pixels near it. With the distortion of `options.lens`,
/// lines are straight in undistorted coordinates. `cells` is the number of cells along an edge: at
/// most one cell on either side is used. Nothing if an edge cannot be fitted.
[[nodiscard]] std::optional<RefinedCorners> refine_corners(
    const GrayImage& image, const std::array<Eigen::Vector2d, 4>& corners, int cells,
    const TagDetectorOptions& options);

}  // namespace pcavr
