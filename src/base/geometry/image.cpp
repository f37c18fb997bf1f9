// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/geometry/image.hpp"

namespace pcavr {

GrayImage to_gray(const ColorImage& color) {
  GrayImage gray(color.width(), color.height());
  const std::span<const Rgb8> from = color.pixels();
  const std::span<std::uint8_t> to = gray.pixels();
  for (std::size_t i = 0; i < from.size(); ++i) {
    // 0.299, 0.587, 0.114 with 16 fractional bits, rounded.
    const unsigned luma = 19595u * from[i].r + 38470u * from[i].g + 7471u * from[i].b + 32768u;
    to[i] = static_cast<std::uint8_t>(luma >> 16);
  }
  return gray;
}

}  // namespace pcavr
