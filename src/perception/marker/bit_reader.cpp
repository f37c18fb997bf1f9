// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/marker/bit_reader.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/Geometry>

#include "pcavr/base/geometry/pixel.hpp"

#include "perception/marker/square_homography.hpp"

namespace pcavr {
namespace {

double nearest_pixel(const GrayImage& image, const Eigen::Vector2d& pixel) {
  const int x = clamp_to_int(pixel.x() + 0.5, 0, image.width() - 1);
  const int y = clamp_to_int(pixel.y() + 0.5, 0, image.height() - 1);
  return static_cast<double>(image(x, y));
}

}  // namespace

BitReading read_bits(const GrayImage& image, const TagPicture& picture,
                     const std::array<Eigen::Vector2d, 4>& corners) {
  const Eigen::Matrix3d homography = square_homography(corners);
  const int across = picture.cells - 2 * picture.border;
  std::vector<double> values;
  double sum[2] = {0.0, 0.0};
  int count[2] = {0, 0};
  for (int row = 0; row < picture.cells; ++row) {
    for (int column = 0; column < picture.cells; ++column) {
      const Eigen::Vector3d cell(2.0 * (column + 0.5 - picture.border) / across - 1.0,
                                 1.0 - 2.0 * (row + 0.5 - picture.border) / across, 1.0);
      const double value = nearest_pixel(image, (homography * cell).hnormalized());
      const int white = picture.is_white[values.size()] ? 1 : 0;
      sum[white] += value;
      ++count[white];
      values.push_back(value);
    }
  }
  const double threshold = 0.5 * (sum[0] / std::max(count[0], 1) + sum[1] / std::max(count[1], 1));
  BitReading reading;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double contrast = picture.is_white[i] ? values[i] - threshold : threshold - values[i];
    if (contrast < 0.0) ++reading.wrong_bits;
    reading.margin += contrast / static_cast<double>(values.size());
  }
  return reading;
}

}  // namespace pcavr
