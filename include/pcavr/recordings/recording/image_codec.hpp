// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/recordings/recording/png_codec.hpp"

namespace pcavr {

/// Depth as stored, in units of the manifest's scale.
using RawDepthImage = Image<std::uint16_t>;

/// The required size of an image, and its name in errors.
struct ExpectedImage {
  std::string file;
  int width = 0;   ///< [px]
  int height = 0;  ///< [px]
};

/// Decodes the bytes of one image file. Corrupt data is an Error; nothing is printed. Safe for
/// untrusted bytes: memory is bounded by the expected size. Reuses its working memory from image to
/// image; use one per thread.
class ImageDecoder {
 public:
  /// JPEG or PNG with 8 bits per channel. Gray is taken as equal red, green and blue; alpha is
  /// dropped.
  [[nodiscard]] Expected<ColorImage> color(std::string_view bytes, const ExpectedImage& image);
  /// PNG with one channel of 16 bits, in its own units.
  [[nodiscard]] Expected<RawDepthImage> raw_depth(std::string_view bytes,
                                                  const ExpectedImage& image);
  /// The same in metres; here `image` has the colour's size, and depth may be smaller by one factor
  /// in width and height (pcavr/base/geometry/depth_grid.hpp).
  [[nodiscard]] Expected<DepthImage> depth(std::string_view bytes, const ExpectedImage& image,
                                           double units_per_metre);

 private:
  [[nodiscard]] Expected<ColorImage> color_png(std::string_view bytes, const ExpectedImage& image);
  using SizeCheck = std::optional<Error> (*)(const ExpectedImage&, const PngImage& header);
  /// Decodes into `png_`, which then has one channel of 16 bits.
  [[nodiscard]] Expected<void> gray16(std::string_view bytes, const ExpectedImage& image,
                                      SizeCheck check);

  PngImage png_;
};

/// JPEG with 4:2:0 chroma subsampling; `quality` from 1 to 100.
[[nodiscard]] Expected<std::string> encode_color(const ColorImage& image, int quality = 95);
/// PNG with three channels of 8 bits.
[[nodiscard]] std::string encode_color_png(const ColorImage& image);
/// Depth in whole units, rounded; what is out of range of 16 bits becomes 0.
[[nodiscard]] RawDepthImage to_raw_depth(const DepthImage& depth, double units_per_metre);
/// PNG with one channel of 16 bits.
[[nodiscard]] std::string encode_depth(const RawDepthImage& image);

/// Whether a file is named as a PNG or a JPEG image.
[[nodiscard]] bool is_picture_file(const std::filesystem::path& file);

}  // namespace pcavr
