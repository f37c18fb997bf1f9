// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recordings/bag_import/raw_color.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace pcavr {
namespace {

/// The layout in which the bytes of an encoding give a pixel's colour.
struct ColorEncoding {
  enum class Layout { channels, yuv422, bayer };

  std::string_view name;
  Layout layout = Layout::channels;
  int bytes = 3;  ///< of a pixel
  /// Places of red, green, blue in a pixel; of luma and of the two colour differences in a pair.
  std::array<int, 3> at = {0, 1, 2};
  std::string_view pattern = {};  ///< Bayer: the colours of two pixels of two rows
};

constexpr auto kChannels = ColorEncoding::Layout::channels;
constexpr auto kYuv422 = ColorEncoding::Layout::yuv422;
constexpr auto kBayer = ColorEncoding::Layout::bayer;

constexpr ColorEncoding kColorEncodings[] = {{"rgb8"},
                                             {"bgr8", kChannels, 3, {2, 1, 0}},
                                             {"8UC3", kChannels, 3, {2, 1, 0}},
                                             {"rgba8", kChannels, 4, {0, 1, 2}},
                                             {"bgra8", kChannels, 4, {2, 1, 0}},
                                             {"8UC4", kChannels, 4, {2, 1, 0}},
                                             {"mono8", kChannels, 1, {0, 0, 0}},
                                             {"8UC1", kChannels, 1, {0, 0, 0}},
                                             {"yuv422", kYuv422, 2, {1, 0, 2}},
                                             {"uyvy", kYuv422, 2, {1, 0, 2}},
                                             {"yuv422_yuy2", kYuv422, 2, {0, 1, 3}},
                                             {"yuyv", kYuv422, 2, {0, 1, 3}},
                                             {"bayer_rggb8", kBayer, 1, {}, "rggb"},
                                             {"bayer_bggr8", kBayer, 1, {}, "bggr"},
                                             {"bayer_gbrg8", kBayer, 1, {}, "gbrg"},
                                             {"bayer_grbg8", kBayer, 1, {}, "grbg"}};

const ColorEncoding* find_color_encoding(std::string_view name) {
  const auto* found = std::find_if(std::begin(kColorEncodings), std::end(kColorEncodings),
                                   [&](const ColorEncoding& known) { return known.name == name; });
  return found == std::end(kColorEncodings) ? nullptr : found;
}

const std::uint8_t* row_of(const RosImage& message, int y) {
  return message.data.data() + static_cast<std::size_t>(y) * message.step;
}

std::uint8_t rounded(double value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
}

/// Colour of the first or second pixel of the pair that begins at `pair`.
Rgb8 yuv_pixel(const std::uint8_t* pair, bool is_second, const ColorEncoding& encoding) {
  const double y = 1.164 * (pair[encoding.at[0] + (is_second ? 2 : 0)] - 16.0);
  const double u = pair[encoding.at[1]] - 128.0;
  const double v = pair[encoding.at[2]] - 128.0;
  return {rounded(y + 1.596 * v), rounded(y - 0.392 * u - 0.813 * v), rounded(y + 2.017 * u)};
}

/// The pixel's own value for its colour, and the mean of those around it for the others.
Rgb8 bayer_pixel(const RosImage& message, int x, int y, std::string_view pattern) {
  const auto channel_at = [&](int i, int j) {
    const char color = pattern[static_cast<std::size_t>(2 * (j % 2) + i % 2)];
    return color == 'r' ? 0U : color == 'g' ? 1U : 2U;
  };
  std::array<int, 3> sum{}, count{};
  for (int j = std::max(y - 1, 0); j <= std::min(y + 1, message.height - 1); ++j) {
    for (int i = std::max(x - 1, 0); i <= std::min(x + 1, message.width - 1); ++i) {
      sum[channel_at(i, j)] += row_of(message, j)[i];
      ++count[channel_at(i, j)];
    }
  }
  sum[channel_at(x, y)] = row_of(message, y)[x];
  count[channel_at(x, y)] = 1;
  const auto mean = [&](std::size_t channel) {
    const int n = std::max(count[channel], 1);  // a single row or column lacks a colour
    return static_cast<std::uint8_t>((sum[channel] + n / 2) / n);
  };
  return {mean(0), mean(1), mean(2)};
}

Rgb8 color_pixel(const RosImage& message, int x, int y, const ColorEncoding& encoding) {
  const std::uint8_t* row = row_of(message, y);
  switch (encoding.layout) {
    case ColorEncoding::Layout::yuv422:
      return yuv_pixel(row + 2 * (x - x % 2), x % 2 == 1, encoding);
    case ColorEncoding::Layout::bayer:
      return bayer_pixel(message, x, y, encoding.pattern);
    case ColorEncoding::Layout::channels:
      break;
  }
  const std::uint8_t* pixel = row + x * encoding.bytes;
  return {pixel[encoding.at[0]], pixel[encoding.at[1]], pixel[encoding.at[2]]};
}

}  // namespace

bool is_color_encoding(std::string_view encoding) {
  return find_color_encoding(encoding) != nullptr;
}

Expected<ColorImage> load_raw_color(const RosImage& message) {
  const ColorEncoding* encoding = find_color_encoding(message.encoding);
  if (encoding == nullptr) {
    return Error{.message = "colour image of encoding '" + message.encoding + "'"};
  }
  const bool is_pairs = encoding->layout == ColorEncoding::Layout::yuv422;
  const int whole_width = message.width + (is_pairs ? message.width % 2 : 0);
  if (message.step <
      static_cast<std::uint32_t>(whole_width) * static_cast<std::uint32_t>(encoding->bytes)) {
    return Error{.message = "image rows of " + std::to_string(message.step) +
                            " bytes are too short for " + message.encoding};
  }
  ColorImage image(message.width, message.height);
  for (int y = 0; y < message.height; ++y) {
    for (int x = 0; x < message.width; ++x) image(x, y) = color_pixel(message, x, y, *encoding);
  }
  return image;
}

}  // namespace pcavr
