// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/image_codec.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <memory>
#include <optional>

#include <turbojpeg.h>

#include "pcavr/base/geometry/depth_grid.hpp"

namespace pcavr {
namespace {

struct JpegDeleter {
  void operator()(void* handle) const { tjDestroy(handle); }
};
using JpegHandle = std::unique_ptr<void, JpegDeleter>;

struct JpegHeader {
  int width = 0;
  int height = 0;
};

Error decode_error(const ExpectedImage& image, const std::string& reason) {
  return {.message = "can't be decoded: " + reason,
          .file = image.file,
          .hint = "replace the image, or skip such frames with --skip-bad"};
}

std::string size_text(int width, int height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

template <typename Header>
std::optional<Error> check_size(const ExpectedImage& image, const Header& header) {
  if (header.width == image.width && header.height == image.height) return std::nullopt;
  return Error{.message = "is " + size_text(header.width, header.height) + " pixels, not " +
                          size_text(image.width, image.height),
               .file = image.file,
               .hint = "the camera of recording.yaml must have the size of the images"};
}

std::optional<Error> check_depth_size(const ExpectedImage& image, const PngImage& header) {
  CameraModel color;
  color.width = image.width;
  color.height = image.height;
  if (is_depth_grid(color, header.width, header.height)) return std::nullopt;
  return Error{.message = "is " + size_text(header.width, header.height) + " pixels, not " +
                          size_text(image.width, image.height) +
                          " nor smaller than that by one factor in width and height",
               .file = image.file,
               .hint =
                   "register depth to the colour image of recording.yaml's camera: the same "
                   "view, the same aspect ratio"};
}

bool is_jpeg(std::string_view bytes) { return bytes.starts_with("\xFF\xD8"); }

const unsigned char* as_bytes(std::string_view bytes) {
  return reinterpret_cast<const unsigned char*>(bytes.data());
}

Expected<ColorImage> decode_jpeg(std::string_view bytes, const ExpectedImage& image) {
  const JpegHandle handle(tjInitDecompress());
  JpegHeader header;
  int subsampling = 0;
  int colorspace = 0;
  if (tjDecompressHeader3(handle.get(), as_bytes(bytes), bytes.size(), &header.width,
                          &header.height, &subsampling, &colorspace) != 0) {
    return decode_error(image, tjGetErrorStr2(handle.get()));
  }
  if (std::optional<Error> error = check_size(image, header)) return *std::move(error);
  ColorImage color(header.width, header.height);
  if (tjDecompress2(handle.get(), as_bytes(bytes), bytes.size(),
                    reinterpret_cast<unsigned char*>(color.pixels().data()), header.width, 0,
                    header.height, TJPF_RGB, TJFLAG_LIMITSCANS) != 0) {
    return decode_error(image, tjGetErrorStr2(handle.get()));
  }
  return color;
}

/// The first channels of 8-bit pixels as colour.
ColorImage to_color(const PngImage& png) {
  ColorImage color(png.width, png.height);
  const std::size_t green = png.channels >= 3 ? 1 : 0;
  const std::size_t blue = png.channels >= 3 ? 2 : 0;
  for (int y = 0; y < png.height; ++y) {
    const std::uint8_t* from = png.row(y);
    for (Rgb8& pixel : color.row(y)) {
      pixel = {from[0], from[green], from[blue]};
      from += png.pixel_size();
    }
  }
  return color;
}

/// Applies `convert` to each 16-bit pixel.
template <typename Pixel, typename Convert>
Image<Pixel> from_gray16(const PngImage& png, Convert convert) {
  Image<Pixel> image(png.width, png.height);
  for (int y = 0; y < png.height; ++y) {
    const std::uint8_t* from = png.row(y);
    for (Pixel& pixel : image.row(y)) {
      pixel = convert(static_cast<std::uint16_t>(from[0] << 8 | from[1]));
      from += 2;
    }
  }
  return image;
}

}  // namespace

Expected<ColorImage> ImageDecoder::color(std::string_view bytes, const ExpectedImage& image) {
  return is_jpeg(bytes) ? decode_jpeg(bytes, image) : color_png(bytes, image);
}

Expected<ColorImage> ImageDecoder::color_png(std::string_view bytes, const ExpectedImage& image) {
  const Expected<PngImage> header = decode_png_header(bytes);
  if (!header) return decode_error(image, header.error().message);
  if (std::optional<Error> error = check_size(image, *header)) return *std::move(error);
  if (header->bit_depth != 8) {
    return Error{.message = "is not a colour image: it has 16 bits per channel",
                 .file = image.file,
                 .hint = "colour images are JPEG or PNG files with 8 bits per channel"};
  }
  if (const Expected<void> done = decode_png(bytes, png_); !done) {
    return decode_error(image, done.error().message);
  }
  return to_color(png_);
}

Expected<void> ImageDecoder::gray16(std::string_view bytes, const ExpectedImage& image,
                                    SizeCheck check) {
  const Expected<PngImage> header = decode_png_header(bytes);
  if (!header) return decode_error(image, header.error().message);
  if (std::optional<Error> error = check(image, *header)) return *std::move(error);
  if (header->bit_depth != 16 || header->channels != 1) {
    return Error{.message = "is not a depth image: it has " + std::to_string(header->channels) +
                            " channels of " + std::to_string(header->bit_depth) + " bits",
                 .file = image.file,
                 .hint = "depth images are PNG files with one channel of 16 bits"};
  }
  if (const Expected<void> done = decode_png(bytes, png_); !done) {
    return decode_error(image, done.error().message);
  }
  return {};
}

Expected<RawDepthImage> ImageDecoder::raw_depth(std::string_view bytes,
                                                const ExpectedImage& image) {
  if (const Expected<void> done = gray16(bytes, image, check_size<PngImage>); !done)
    return done.error();
  return from_gray16<std::uint16_t>(png_, [](std::uint16_t units) { return units; });
}

Expected<DepthImage> ImageDecoder::depth(std::string_view bytes, const ExpectedImage& image,
                                         double units_per_metre) {
  if (const Expected<void> done = gray16(bytes, image, check_depth_size); !done) {
    return done.error();
  }
  const auto metres_per_unit = static_cast<float>(1.0 / units_per_metre);
  return from_gray16<float>(
      png_, [=](std::uint16_t units) { return static_cast<float>(units) * metres_per_unit; });
}

Expected<std::string> encode_color(const ColorImage& image, int quality) {
  const JpegHandle handle(tjInitCompress());
  unsigned char* buffer = nullptr;
  unsigned long size = 0;
  const int code = tjCompress2(
      handle.get(), reinterpret_cast<const unsigned char*>(image.pixels().data()), image.width(), 0,
      image.height(), TJPF_RGB, &buffer, &size, TJSAMP_420, quality, 0);
  const std::unique_ptr<unsigned char, decltype(&tjFree)> owner(buffer, tjFree);
  if (code != 0) {
    return Error{.message =
                     std::string("an image can't be encoded: ") + tjGetErrorStr2(handle.get())};
  }
  return std::string(reinterpret_cast<const char*>(buffer), size);
}

std::string encode_color_png(const ColorImage& image) {
  constexpr std::uint8_t kSub = 1;  // [ISO/IEC 15948:2004, 9.2]: differences to the pixel before
  PngImage png{.width = image.width(), .height = image.height(), .bit_depth = 8, .channels = 3};
  png.rows.reserve(static_cast<std::size_t>(image.height()) * (png.row_size() + 1));
  for (int y = 0; y < image.height(); ++y) {
    png.rows.push_back(kSub);
    Rgb8 before;
    for (const Rgb8& pixel : image.row(y)) {
      png.rows.push_back(static_cast<std::uint8_t>(pixel.r - before.r));
      png.rows.push_back(static_cast<std::uint8_t>(pixel.g - before.g));
      png.rows.push_back(static_cast<std::uint8_t>(pixel.b - before.b));
      before = pixel;
    }
  }
  return encode_png(png);
}

RawDepthImage to_raw_depth(const DepthImage& depth, double units_per_metre) {
  RawDepthImage raw(depth.width(), depth.height());
  const std::span<const float> from = depth.pixels();
  const std::span<std::uint16_t> to = raw.pixels();
  for (std::size_t i = 0; i < from.size(); ++i) {
    const double units = std::round(static_cast<double>(from[i]) * units_per_metre);
    to[i] = units >= 1.0 && units <= 65535.0 ? static_cast<std::uint16_t>(units) : 0;
  }
  return raw;
}

std::string encode_depth(const RawDepthImage& image) {
  PngImage png{.width = image.width(), .height = image.height(), .bit_depth = 16, .channels = 1};
  png.rows.reserve(static_cast<std::size_t>(image.height()) * (png.row_size() + 1));
  for (int y = 0; y < image.height(); ++y) {
    // No filter: on depth, whose low bits are noise, filters increase the size by 5 % (measured).
    png.rows.push_back(0);
    for (const std::uint16_t pixel : image.row(y)) {
      png.rows.push_back(static_cast<std::uint8_t>(pixel >> 8));
      png.rows.push_back(static_cast<std::uint8_t>(pixel & 0xFF));
    }
  }
  return encode_png(png);
}

bool is_picture_file(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg";
}

}  // namespace pcavr
