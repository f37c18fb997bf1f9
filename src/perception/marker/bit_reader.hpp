// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <Eigen/Core>

#include "pcavr/base/geometry/image.hpp"
#include "pcavr/perception/marker/tag_sheet.hpp"

namespace pcavr {

/// Agreement of the cells in the image with a tag's bit pattern.
struct BitReading {
  int wrong_bits = 0;   ///< cells on the wrong side of the threshold
  double margin = 0.0;  ///< mean contrast to the threshold, of 255
};

/// Samples the grey value at each cell's centre; the threshold is midway between the mean of the
/// cells expected to be white and the mean of those expected to be black.
[[nodiscard]] BitReading read_bits(const GrayImage& image, const TagPicture& picture,
                                   const std::array<Eigen::Vector2d, 4>& corners);

}  // namespace pcavr
