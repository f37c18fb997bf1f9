// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "pcavr/core/expected.hpp"
#include "pcavr/geometry/image.hpp"

namespace pcavr {

/// Depth as stored, in units of the manifest's scale.
using RawDepthImage = Image<std::uint16_t>;

/// What an image must be, and the name that errors give it.
struct ExpectedImage {
  std::string file;
  int width = 0;   ///< [px]
  int height = 0;  ///< [px]
};

/// Decode the bytes of one file. All that is not wholly sound is an Error; nothing is printed.
/// Safe for bytes from anywhere: memory is bounded by the size expected. Thread-safe.

/// JPEG or PNG with 8 bits a channel. Gray is taken as equal red, green and blue; alpha is dropped.
[[nodiscard]] Expected<ColorImage> decode_color(std::string_view bytes, const ExpectedImage& image);
/// PNG with one channel of 16 bits.
[[nodiscard]] Expected<RawDepthImage> decode_depth(std::string_view bytes,
                                                   const ExpectedImage& image);

/// JPEG of quality 95 with halved chroma.
[[nodiscard]] Expected<std::string> encode_color(const ColorImage& image);
/// PNG with one channel of 16 bits.
[[nodiscard]] std::string encode_depth(const RawDepthImage& image);

}  // namespace pcavr
