// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pcavr/core/expected.hpp"

namespace pcavr {

/// A PNG file [ISO/IEC 15948:2004], inflated. Only what cameras write is read: 8 or 16 bits, no
/// palette, not interlaced. Inflating takes libdeflate a third of zlib's time.
struct PngImage {
  int width = 0;      ///< [px]
  int height = 0;     ///< [px]
  int bit_depth = 0;  ///< 8 or 16
  int channels = 0;   ///< 1 gray, 2 gray and alpha, 3 colour, 4 colour and alpha
  std::vector<std::uint8_t> rows =
      {};  ///< each its filter's number, 0 if none, then pixels, big-endian

  [[nodiscard]] std::size_t pixel_size() const {
    return static_cast<std::size_t>(bit_depth / 8 * channels);
  }
  [[nodiscard]] std::size_t row_size() const {
    return static_cast<std::size_t>(width) * pixel_size();
  }
  /// The first byte of row y's pixels.
  [[nodiscard]] const std::uint8_t* row(int y) const {
    return rows.data() + static_cast<std::size_t>(y) * (row_size() + 1) + 1;
  }
};

/// What the header promises, without `rows`. Errors have neither file nor hint.
[[nodiscard]] Expected<PngImage> decode_png_header(std::string_view bytes);

/// The whole image into `image`, without filters, whose memory is used again: fresh memory costs
/// more time than inflating. Checksums are checked. Memory in proportion to the header's size:
/// check that first. Errors have neither file nor hint, and leave `image` without meaning.
[[nodiscard]] Expected<void> decode_png(std::string_view bytes, PngImage& image);

/// The file of an image whose rows hold the filters that they name (0: plain pixels).
[[nodiscard]] std::string encode_png(const PngImage& image);

}  // namespace pcavr
