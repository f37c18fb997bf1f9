// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

namespace pcavr {

/// A rectangle of pixels: [left, right) by [top, bottom).
struct Region {
  int left = 0;
  int top = 0;
  int right = 0;
  int bottom = 0;

  [[nodiscard]] int width() const { return right - left; }
  [[nodiscard]] int height() const { return bottom - top; }
  [[nodiscard]] long area() const { return static_cast<long>(width()) * height(); }
  bool operator==(const Region&) const = default;
};

/// Regions of interest (ROI) for tags that had these corners in the previous frame: around each, by
/// the possible motion of a hand-held camera, `motion_share` of the image's width; overlapping
/// regions are merged. Left and top are
/// multiples of 8, so that a region is thresholded and downscaled like the whole image.
[[nodiscard]] std::vector<Region> regions_around(
    const std::vector<std::array<Eigen::Vector2d, 4>>& tags, int width, int height,
    double motion_share);

}  // namespace pcavr
