// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <Eigen/Core>

#include "pcavr/geometry/image.hpp"
#include "pcavr/marker/tag_sheet.hpp"

namespace pcavr {

/// How well the cells in the image agree with a tag's picture.
struct BitReading {
  int wrong_bits = 0;   ///< cells on the wrong side of the threshold
  double margin = 0.0;  ///< mean distance of the right cells from the threshold, of 255
};

/// Reads the grey value at each cell's centre; the threshold lies midway between the mean of the
/// cells that should be white and the mean of those that should be black.
[[nodiscard]] BitReading read_bits(const GrayImage& image, const TagPicture& picture,
                                   const std::array<Eigen::Vector2d, 4>& corners);

}  // namespace pcavr
