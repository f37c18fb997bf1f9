// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

namespace pcavr {

// A float that is out of an int's range, or not a number, may not be cast to one: what comes out is
// undefined, and an index made of it reads anywhere. These two test first.

/// The row or column of pixels that a position falls on; nothing outside an image of that size.
[[nodiscard]] constexpr std::optional<int> pixel_index(double position, int size) {
  // Written so that what is not a number fails.
  if (!(position >= -0.5 && position < size - 0.5)) return std::nullopt;
  return static_cast<int>(position + 0.5);
}

/// The whole part of `value`, kept between two bounds; what is not a number gives `min`.
[[nodiscard]] constexpr int clamp_to_int(double value, int min, int max) {
  if (!(value > min)) return min;
  return value < max ? static_cast<int>(value) : max;
}

}  // namespace pcavr
