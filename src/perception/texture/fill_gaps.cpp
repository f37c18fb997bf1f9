// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "fill_gaps.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace pcavr {
namespace {

/// Colour times weight, and weight (0 or 1 after normalisation).
using Level = Image<Eigen::Vector4f>;

constexpr int kMaxContinued = 12;  ///< [px]

struct OpenPixel {
  int x;
  int y;
  Rgb8 color;
};

std::uint8_t to_byte(float value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0F, 255.0F)));
}

/// Mean of the sure pixels around one; nullopt where there is none.
std::optional<Rgb8> mean_around(const ColorImage& image, const MaskImage& is_sure, int x, int y) {
  Eigen::Vector4f sum = Eigen::Vector4f::Zero();
  for (int at_y = y - 1; at_y <= y + 1; ++at_y) {
    for (int at_x = x - 1; at_x <= x + 1; ++at_x) {
      if (!image.contains(at_x, at_y) || is_sure(at_x, at_y) == 0) continue;
      const Rgb8& c = image(at_x, at_y);
      sum += Eigen::Vector4f(c.r, c.g, c.b, 1.0F);
    }
  }
  if (sum.w() == 0.0F) return std::nullopt;
  return Rgb8{to_byte(sum.x() / sum.w()), to_byte(sum.y() / sum.w()), to_byte(sum.z() / sum.w())};
}

Level half_of(int width, int height, const auto& value_at) {
  Level half((width + 1) / 2, (height + 1) / 2, Eigen::Vector4f::Zero());
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) half(x / 2, y / 2) += value_at(x, y);
  }
  for (Eigen::Vector4f& sum : half.pixels()) {
    if (sum.w() > 0.0F) sum /= sum.w();
  }
  return half;
}

/// Bilinear between the centres of a half as large image's pixels.
Eigen::Vector3f upsampled(const Level& half, int x, int y) {
  const int near_x = x / 2;
  const int near_y = y / 2;
  const int far_x = std::clamp(near_x + (x % 2 == 0 ? -1 : 1), 0, half.width() - 1);
  const int far_y = std::clamp(near_y + (y % 2 == 0 ? -1 : 1), 0, half.height() - 1);
  const Eigen::Vector4f sum = 0.5625F * half(near_x, near_y) + 0.1875F * half(far_x, near_y) +
                              0.1875F * half(near_x, far_y) + 0.0625F * half(far_x, far_y);
  return sum.head<3>();
}

}  // namespace

void fill_gaps(ColorImage& image, const MaskImage& is_known) {
  std::vector<Level> levels;
  levels.push_back(half_of(image.width(), image.height(), [&](int x, int y) -> Eigen::Vector4f {
    if (is_known(x, y) == 0) return Eigen::Vector4f::Zero();
    const Rgb8& c = image(x, y);
    return {float(c.r), float(c.g), float(c.b), 1.0F};
  }));
  while (levels.back().width() > 1 || levels.back().height() > 1) {
    const Level& last = levels.back();
    Level next = half_of(last.width(), last.height(),
                         [&](int x, int y) -> Eigen::Vector4f { return last(x, y); });
    levels.push_back(std::move(next));
  }
  for (std::size_t i = levels.size() - 1; i-- > 0;) {
    Level& level = levels[i];
    for (int y = 0; y < level.height(); ++y) {
      for (int x = 0; x < level.width(); ++x) {
        if (level(x, y).w() > 0.0F) continue;
        level(x, y).head<3>() = upsampled(levels[i + 1], x, y);
      }
    }
    for (Eigen::Vector4f& value : level.pixels()) value.w() = 1.0F;
  }
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      if (is_known(x, y) != 0) continue;
      const Eigen::Vector3f color = upsampled(levels.front(), x, y);
      image(x, y) = {to_byte(color.x()), to_byte(color.y()), to_byte(color.z())};
    }
  }
}

void continue_colors(ColorImage& image, const MaskImage& is_seen, const MaskImage& is_doubtful) {
  MaskImage is_sure = is_seen;
  std::vector<OpenPixel> open;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      if (is_doubtful(x, y) == 0) continue;
      is_sure(x, y) = 0;
      open.push_back({x, y, {}});
    }
  }
  for (int step = 0; step < kMaxContinued && !open.empty(); ++step) {
    const auto reached = std::partition(open.begin(), open.end(), [&](OpenPixel& pixel) {
      const std::optional<Rgb8> mean = mean_around(image, is_sure, pixel.x, pixel.y);
      if (mean) pixel.color = *mean;
      return !mean;
    });
    // Afterwards, so that the order of the pixels does not matter.
    for (auto at = reached; at != open.end(); ++at) {
      image(at->x, at->y) = at->color;
      is_sure(at->x, at->y) = 1;
    }
    open.erase(reached, open.end());
  }
}

}  // namespace pcavr
