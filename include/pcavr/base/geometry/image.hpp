// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pcavr/base/core/check.hpp"

namespace pcavr {

struct Rgb8 {
  std::uint8_t r = 0;
  std::uint8_t g = 0;
  std::uint8_t b = 0;
  bool operator==(const Rgb8&) const = default;
};

/// A row-major image that owns its pixels; rows are contiguous.
template <typename Pixel>
class Image {
 public:
  Image() = default;
  Image(int width, int height, Pixel fill = Pixel{}) : width_(width), height_(height) {
    PCAVR_REQUIRE(width >= 0 && height >= 0, width, height);
    pixels_.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), fill);
  }

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] bool empty() const { return pixels_.empty(); }
  [[nodiscard]] bool contains(int x, int y) const {
    return x >= 0 && y >= 0 && x < width_ && y < height_;
  }

  /// No bounds check: (x, y) must lie inside.
  [[nodiscard]] const Pixel& operator()(int x, int y) const { return pixels_[index(x, y)]; }
  [[nodiscard]] Pixel& operator()(int x, int y) { return pixels_[index(x, y)]; }

  [[nodiscard]] std::span<const Pixel> row(int y) const {
    return {pixels_.data() + index(0, y), static_cast<std::size_t>(width_)};
  }
  [[nodiscard]] std::span<Pixel> row(int y) {
    return {pixels_.data() + index(0, y), static_cast<std::size_t>(width_)};
  }
  [[nodiscard]] std::span<const Pixel> pixels() const { return pixels_; }
  [[nodiscard]] std::span<Pixel> pixels() { return pixels_; }

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  }

  int width_ = 0;
  int height_ = 0;
  std::vector<Pixel> pixels_;
};

using GrayImage = Image<std::uint8_t>;
using ColorImage = Image<Rgb8>;
/// Depth along the optical axis [m]; 0 where nothing was measured.
using DepthImage = Image<float>;
/// Non-zero where a pixel is to be ignored.
using MaskImage = Image<std::uint8_t>;

/// Luma (ITU-R BT.601), rounded.
[[nodiscard]] GrayImage to_gray(const ColorImage& color);

}  // namespace pcavr
