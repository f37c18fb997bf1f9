// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/geometry/depth_grid.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcavr {
namespace {

/// The fine pixels that a coarse pixel covers, with the covered fraction of the first and last one.
struct Span {
  int first = 0;
  int last = 0;               ///< inclusive
  float first_weight = 1.0F;  ///< 0 to 1
  float last_weight = 1.0F;

  [[nodiscard]] float weight(int i) const {
    return i == first ? first_weight : i == last ? last_weight : 1.0F;
  }
};

std::vector<Span> spans(int fine, int coarse) {
  std::vector<Span> all;
  for (std::int64_t i = 0; i < coarse; ++i) {
    // In units of 1/coarse of a fine pixel all bounds are integers.
    const std::int64_t begin = i * fine;
    const std::int64_t end = begin + fine;
    Span span{.first = static_cast<int>(begin / coarse),
              .last = static_cast<int>((end - 1) / coarse)};
    const auto fraction = [coarse](std::int64_t part) {
      return static_cast<float>(part) / static_cast<float>(coarse);
    };
    span.first_weight = fraction(coarse - begin % coarse);
    span.last_weight = fraction((end - 1) % coarse + 1);
    all.push_back(span);
  }
  return all;
}

/// Sums the fine rows of `span`, weighted; the result keeps the fine resolution along the row.
void sum_rows(const ColorImage& color, const Span& span, std::vector<float>& sums) {
  std::fill(sums.begin(), sums.end(), 0.0F);
  for (int y = span.first; y <= span.last; ++y) {
    const float weight = span.weight(y);
    float* sum = sums.data();
    for (const Rgb8& pixel : color.row(y)) {
      sum[0] += weight * pixel.r;
      sum[1] += weight * pixel.g;
      sum[2] += weight * pixel.b;
      sum += 3;
    }
  }
}

}  // namespace

bool is_depth_grid(const CameraModel& color, int width, int height) {
  return width >= 1 && height >= 1 && width <= color.width &&
         std::int64_t{width} * color.height == std::int64_t{height} * color.width;
}

CameraModel on_grid(const CameraModel& color, int width, int height) {
  PCAVR_REQUIRE(is_depth_grid(color, width, height), width, height, color.width, color.height);
  if (width == color.width) return color;
  CameraModel camera = color;
  camera.width = width;
  camera.height = height;
  camera.fx *= static_cast<double>(width) / color.width;
  camera.fy *= static_cast<double>(height) / color.height;
  const Eigen::Vector2d centre = to_grid({color.cx, color.cy}, color, camera);
  camera.cx = centre.x();
  camera.cy = centre.y();
  return camera;
}

Eigen::Vector2d to_grid(const Eigen::Vector2d& pixel, const CameraModel& from,
                        const CameraModel& to) {
  if (from.width == to.width) return pixel;
  const double scale = static_cast<double>(to.width) / from.width;
  return (scale * (pixel.array() + 0.5) - 0.5).matrix();
}

ColorImage color_on_grid(const ColorImage& color, int width, int height) {
  if (color.width() == width && color.height() == height) return color;
  PCAVR_REQUIRE(width >= 1 && width <= color.width() && height >= 1 && height <= color.height(),
                width, height);
  const std::vector<Span> columns = spans(color.width(), width);
  const std::vector<Span> rows = spans(color.height(), height);
  const float per_area = static_cast<float>(width) / static_cast<float>(color.width()) *
                         static_cast<float>(height) / static_cast<float>(color.height());
  std::vector<float> sums(3 * static_cast<std::size_t>(color.width()));
  ColorImage coarse(width, height);
  for (int y = 0; y < height; ++y) {
    sum_rows(color, rows[static_cast<std::size_t>(y)], sums);
    for (int x = 0; x < width; ++x) {
      const Span& span = columns[static_cast<std::size_t>(x)];
      float mean[3] = {0.0F, 0.0F, 0.0F};
      for (int i = span.first; i <= span.last; ++i) {
        for (std::size_t channel = 0; channel < 3; ++channel) {
          mean[channel] += span.weight(i) * sums[3 * static_cast<std::size_t>(i) + channel];
        }
      }
      const auto channel_value = [&](std::size_t channel) {
        return static_cast<std::uint8_t>(std::min(255.0F, mean[channel] * per_area + 0.5F));
      };
      coarse(x, y) = {channel_value(0), channel_value(1), channel_value(2)};
    }
  }
  return coarse;
}

DepthImage depth_on_color(DepthImage depth, int width, int height) {
  if (depth.empty() || (depth.width() == width && depth.height() == height)) return depth;
  DepthImage fine(width, height);
  const auto nearest = [](int i, int fine_size, int coarse_size) {
    return static_cast<int>((2 * std::int64_t{i} + 1) * coarse_size / (2 * fine_size));
  };
  for (int y = 0; y < height; ++y) {
    const std::span<const float> from = depth.row(nearest(y, height, depth.height()));
    for (int x = 0; x < width; ++x) {
      fine(x, y) = from[static_cast<std::size_t>(nearest(x, width, depth.width()))];
    }
  }
  return fine;
}

}  // namespace pcavr
