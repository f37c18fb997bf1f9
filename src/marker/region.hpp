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

/// Where to look for tags that had these corners a frame ago: around each, as far as a hand-held
/// camera may carry it; regions that overlap become one. Left and top are multiples of 8, so that
/// a part of the image is thresholded and shrunk as the whole is.
[[nodiscard]] std::vector<Region> regions_around(
    const std::vector<std::array<Eigen::Vector2d, 4>>& tags, int width, int height);

}  // namespace pcavr
