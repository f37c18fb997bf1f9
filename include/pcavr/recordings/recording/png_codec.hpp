// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

/// A decompressed PNG file [ISO/IEC 15948:2004]. Only what cameras write is supported: 8 or 16
/// bits, no palette, not interlaced. libdeflate takes a third of zlib's time.
struct PngImage {
  int width = 0;      ///< [px]
  int height = 0;     ///< [px]
  int bit_depth = 0;  ///< 8 or 16
  int channels = 0;   ///< 1 gray, 2 gray and alpha, 3 colour, 4 colour and alpha
  std::vector<std::uint8_t> rows =
      {};  ///< each the filter type, 0 for none, then pixels, big-endian

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

/// Size and format from the header, without `rows`. Errors have neither file nor hint.
[[nodiscard]] Expected<PngImage> decode_png_header(std::string_view bytes);

/// Decodes into `image`, with filters undone, and reuses its memory: page faults of newly allocated
/// memory cost more time than decompression. Verifies checksums. Allocates in proportion to the
/// size in the header: check that first. Errors have neither file nor hint, and leave `image` in an
/// unspecified state.
[[nodiscard]] Expected<void> decode_png(std::string_view bytes, PngImage& image);

/// Encodes an image whose rows are filtered as their filter types state (0: unfiltered).
[[nodiscard]] std::string encode_png(const PngImage& image);

}  // namespace pcavr
