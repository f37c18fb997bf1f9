// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

namespace pcavr {

// Casting a float that is NaN or out of an int's range is undefined behaviour, and an index made
// from it may be out of bounds. These functions check first.

/// The row or column of the pixel that contains a position; nullopt outside an image of that size.
[[nodiscard]] constexpr std::optional<int> pixel_index(double position, int size) {
  // Written so that NaN fails.
  if (!(position >= -0.5 && position < size - 0.5)) return std::nullopt;
  return static_cast<int>(position + 0.5);
}

/// `value` truncated and clamped to [min, max]; NaN gives `min`.
[[nodiscard]] constexpr int clamp_to_int(double value, int min, int max) {
  if (!(value > min)) return min;
  return value < max ? static_cast<int>(value) : max;
}

}  // namespace pcavr
