// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/bag_import/camera_images.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <span>

#include "pcavr/recordings/recording/image_codec.hpp"
#include "pcavr/recordings/recording/png_codec.hpp"

#include "recordings/bag_import/raw_color.hpp"

namespace pcavr {
namespace {

/// Size of the header before the PNG of compressedDepth: the format in 32 bits, and two parameters
/// of inverse depth.
constexpr std::size_t kDepthHeaderSize = 12;

template <typename Number>
Number load_number(const std::uint8_t* bytes, bool is_big_endian) {
  std::array<std::uint8_t, sizeof(Number)> raw{};
  std::copy_n(bytes, sizeof(Number), raw.begin());
  if (is_big_endian) std::reverse(raw.begin(), raw.end());
  return std::bit_cast<Number>(raw);
}

/// Fills an image from rows of `pixel_size` bytes a pixel.
template <typename Pixel, typename Load>
Expected<Image<Pixel>> load_rows(const RosImage& message, std::size_t pixel_size, Load load) {
  if (message.step < static_cast<std::size_t>(message.width) * pixel_size) {
    return Error{.message = "image rows of " + std::to_string(message.step) +
                            " bytes are too short for " + message.encoding};
  }
  Image<Pixel> image(message.width, message.height);
  for (int y = 0; y < message.height; ++y) {
    const std::uint8_t* row = message.data.data() + static_cast<std::size_t>(y) * message.step;
    for (int x = 0; x < message.width; ++x) {
      image(x, y) = load(row + static_cast<std::size_t>(x) * pixel_size);
    }
  }
  return image;
}

/// A measurement in metres that is not finite or negative is none.
float valid_depth(float z) { return std::isfinite(z) && z > 0.0F ? z : 0.0F; }

ConvertedImage encoded_depth(const RawDepthImage& image) {
  return {{encode_depth(image), ".png"}, image.width(), image.height()};
}

Expected<ConvertedImage> convert_raw_depth(const RosImage& message, double depth_scale) {
  const bool is_big_endian = message.is_big_endian;
  if (is_metric_depth(message.encoding)) {
    const auto metres = load_rows<float>(message, 4, [&](const std::uint8_t* pixel) {
      return valid_depth(load_number<float>(pixel, is_big_endian));
    });
    if (!metres) return metres.error();
    return encoded_depth(to_raw_depth(*metres, depth_scale));
  }
  if (message.encoding != "16UC1" && message.encoding != "mono16") {
    return Error{.message = "depth image of encoding '" + message.encoding + "'"};
  }
  const auto units = load_rows<std::uint16_t>(message, 2, [&](const std::uint8_t* pixel) {
    return load_number<std::uint16_t>(pixel, is_big_endian);
  });
  if (!units) return units.error();
  return encoded_depth(*units);
}

std::string_view text_of_bytes(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Inverse depth was quantised: value = a / z + b.
Expected<ConvertedImage> convert_inverse_depth(std::string_view png, const PngImage& header,
                                               float a, float b, double depth_scale) {
  ImageDecoder decoder;
  const Expected<RawDepthImage> units =
      decoder.raw_depth(png, {.file = {}, .width = header.width, .height = header.height});
  if (!units) return Error{.message = units.error().message};
  DepthImage metres(units->width(), units->height());
  std::transform(units->pixels().begin(), units->pixels().end(), metres.pixels().begin(),
                 [&](std::uint16_t unit) {
                   return unit == 0 ? 0.0F : valid_depth(a / (static_cast<float>(unit) - b));
                 });
  return encoded_depth(to_raw_depth(metres, depth_scale));
}

bool has_depth_header(const RosCompressedImage& message) {
  return message.format.find("compressedDepth") != std::string::npos;
}

Expected<ConvertedImage> convert_compressed_depth(const RosCompressedImage& message,
                                                  double depth_scale) {
  const bool has_header = has_depth_header(message);
  const std::size_t skipped = has_header ? kDepthHeaderSize : 0;
  if (message.data.size() <= skipped) return Error{.message = "compressed depth image is empty"};
  const std::string_view png = text_of_bytes(message.data.subspan(skipped));
  const Expected<PngImage> header = decode_png_header(png);
  if (!header) {
    return Error{.message = "compressed depth '" + message.format + "' is no PNG (" +
                            header.error().message + ")",
                 .hint = "RVL is not supported: republish as raw images"};
  }
  if (header->bit_depth != 16 || header->channels != 1) {
    return Error{.message = "compressed depth image has not one channel of 16 bits"};
  }
  if (has_header && is_metric_depth(message.format)) {
    const auto a = load_number<float>(message.data.data() + 4, false);
    const auto b = load_number<float>(message.data.data() + 8, false);
    return convert_inverse_depth(png, *header, a, b, depth_scale);
  }
  return ConvertedImage{{std::string(png), ".png"}, header->width, header->height};
}

Expected<ConvertedImage> convert_raw_color(const RosImage& message) {
  const auto image = load_raw_color(message);
  if (!image) return image.error();
  Expected<std::string> jpeg = encode_color(*image);
  if (!jpeg) return jpeg.error();
  return ConvertedImage{{*std::move(jpeg), ".jpg"}, image->width(), image->height()};
}

/// Width and height in the frame header of a JPEG file [ISO/IEC 10918-1, B.2.2].
std::optional<std::pair<int, int>> jpeg_size(std::span<const std::uint8_t> bytes) {
  for (std::size_t at = 2; at + 9 < bytes.size() && bytes[at] == 0xFF;) {
    const std::uint8_t marker = bytes[at + 1];
    const auto word = [&](std::size_t i) { return bytes[i] * 256 + bytes[i + 1]; };
    const bool is_frame =
        marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (is_frame) return std::pair(word(at + 7), word(at + 5));
    at += marker == 0xFF ? 1 : 2 + static_cast<std::size_t>(word(at + 2));
  }
  return std::nullopt;
}

Expected<ConvertedImage> convert_compressed_color(const RosCompressedImage& message) {
  const std::string_view bytes = text_of_bytes(message.data);
  if (bytes.starts_with("\xFF\xD8")) {
    const auto size = jpeg_size(message.data);
    if (!size) return Error{.message = "JPEG image without a frame header"};
    return ConvertedImage{{std::string(bytes), ".jpg"}, size->first, size->second};
  }
  const Expected<PngImage> header = decode_png_header(bytes);
  if (!header)
    return Error{.message = "compressed image '" + message.format + "' is neither JPEG nor PNG"};
  return ConvertedImage{{std::string(bytes), ".png"}, header->width, header->height};
}

}  // namespace

bool is_metric_depth(const std::string& image_format) { return image_format.starts_with("32FC1"); }

Expected<ConvertedImage> convert_depth(const RosMessage& message, double depth_scale) {
  if (const auto* image = std::get_if<RosImage>(&message)) {
    return convert_raw_depth(*image, depth_scale);
  }
  if (const auto* image = std::get_if<RosCompressedImage>(&message)) {
    return convert_compressed_depth(*image, depth_scale);
  }
  return Error{.message = "is no image"};
}

Expected<ConvertedImage> convert_color(const RosMessage& message) {
  if (const auto* image = std::get_if<RosImage>(&message)) return convert_raw_color(*image);
  if (const auto* image = std::get_if<RosCompressedImage>(&message)) {
    return convert_compressed_color(*image);
  }
  return Error{.message = "is no image"};
}

ImageSize image_size(const RosMessage& message) {
  if (const auto* image = std::get_if<RosImage>(&message)) return {image->width, image->height};
  const auto* compressed = std::get_if<RosCompressedImage>(&message);
  if (compressed == nullptr) return {};
  const std::size_t skipped = has_depth_header(*compressed) ? kDepthHeaderSize : 0;
  if (compressed->data.size() <= skipped) return {};
  const std::span<const std::uint8_t> bytes = compressed->data.subspan(skipped);
  if (text_of_bytes(bytes).starts_with("\xFF\xD8")) {
    const auto size = jpeg_size(bytes);
    return size ? ImageSize{size->first, size->second} : ImageSize{};
  }
  const Expected<PngImage> header = decode_png_header(text_of_bytes(bytes));
  return header ? ImageSize{header->width, header->height} : ImageSize{};
}

Expected<ColorImage> decode_color(const RosMessage& message, int width, int height) {
  const auto is_other = [&](int w, int h) { return w != width || h != height; };
  const auto other_size = [&](int w, int h) {
    return Error{.message = "image of " + std::to_string(w) + " x " + std::to_string(h) +
                            " pixels, not " + std::to_string(width) + " x " +
                            std::to_string(height)};
  };
  if (const auto* image = std::get_if<RosImage>(&message)) {
    if (is_other(image->width, image->height)) return other_size(image->width, image->height);
    return load_raw_color(*image);
  }
  const Expected<ConvertedImage> file = convert_color(message);
  if (!file) return file.error();
  // The size is checked before the image is decoded: a few bytes may state a size of gigabytes.
  if (is_other(file->width, file->height)) return other_size(file->width, file->height);
  ImageDecoder decoder;
  Expected<ColorImage> image =
      decoder.color(file->file.bytes, {.file = {}, .width = file->width, .height = file->height});
  if (!image) return Error{.message = image.error().message};
  return image;
}

}  // namespace pcavr
