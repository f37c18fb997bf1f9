// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

#include "pcavr/geometry/camera.hpp"
#include "pcavr/geometry/image.hpp"

namespace pcavr {

struct RefinedCorners {
  std::array<Eigen::Vector2d, 4> corners;  ///< [px]
  double sigma = 0.0;                      ///< [px], of one coordinate, as the grey noise tells it
};

/// Places the corners of a square where its four edges meet. Each edge is a straight line between
/// a dark and a bright side, blurred by a Gaussian; line, both brightnesses and the blur are fitted
/// to the grey values of all pixels near it. With a `lens` whose distortion bends straight edges,
/// lines are straight in undistorted coordinates. `cells` is the number of cells along an edge:
/// nothing but one cell on either side is looked at. Nothing where an edge is not to be made out.
[[nodiscard]] std::optional<RefinedCorners> refine_corners(
    const GrayImage& image, const std::array<Eigen::Vector2d, 4>& corners, int cells,
    const std::optional<CameraModel>& lens);

}  // namespace pcavr
