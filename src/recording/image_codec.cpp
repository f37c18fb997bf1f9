// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recording/image_codec.hpp"

#include <algorithm>
#include <cstring>
#include <memory>
#include <optional>

#include <spng.h>
#include <turbojpeg.h>

namespace pcavr {
namespace {

using PngContext = std::unique_ptr<spng_ctx, decltype(&spng_ctx_free)>;

struct JpegDeleter {
  void operator()(void* handle) const { tjDestroy(handle); }
};
using JpegHandle = std::unique_ptr<void, JpegDeleter>;

constexpr int kJpegQuality = 95;

Error damaged(const ExpectedImage& image, const std::string& reason) {
  return {.message = "does not decode: " + reason,
          .file = image.file,
          .mend = "replace the image, or leave such frames out with --skip-bad"};
}

std::string size_text(std::int64_t width, std::int64_t height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

std::optional<Error> check_size(const ExpectedImage& image, std::int64_t width,
                                std::int64_t height) {
  if (width == image.width && height == image.height) return std::nullopt;
  return Error{.message = "is " + size_text(width, height) + " pixels, not " +
                          size_text(image.width, image.height),
               .file = image.file,
               .mend = "the camera of recording.yaml must have the size of the images"};
}

bool is_jpeg(std::string_view bytes) { return bytes.starts_with("\xFF\xD8"); }

const unsigned char* as_bytes(std::string_view bytes) {
  return reinterpret_cast<const unsigned char*>(bytes.data());
}

Expected<ColorImage> decode_jpeg(std::string_view bytes, const ExpectedImage& image) {
  const JpegHandle handle(tjInitDecompress());
  int width = 0;
  int height = 0;
  int subsampling = 0;
  int colorspace = 0;
  if (tjDecompressHeader3(handle.get(), as_bytes(bytes), bytes.size(), &width, &height,
                          &subsampling, &colorspace) != 0) {
    return damaged(image, tjGetErrorStr2(handle.get()));
  }
  if (std::optional<Error> error = check_size(image, width, height)) return *std::move(error);
  ColorImage color(width, height);
  if (tjDecompress2(handle.get(), as_bytes(bytes), bytes.size(),
                    reinterpret_cast<unsigned char*>(color.pixels().data()), width, 0, height,
                    TJPF_RGB, 0) != 0) {
    return damaged(image, tjGetErrorStr2(handle.get()));
  }
  return color;
}

/// The header of a PNG file of the size expected.
Expected<spng_ihdr> open_png(spng_ctx* context, std::string_view bytes,
                             const ExpectedImage& image) {
  if (const int code = spng_set_png_buffer(context, bytes.data(), bytes.size()); code != 0) {
    return damaged(image, spng_strerror(code));
  }
  spng_ihdr header{};
  if (const int code = spng_get_ihdr(context, &header); code != 0) {
    return damaged(image, spng_strerror(code));
  }
  if (std::optional<Error> error = check_size(image, header.width, header.height)) {
    return *std::move(error);
  }
  return header;
}

Expected<ColorImage> decode_color_png(std::string_view bytes, const ExpectedImage& image) {
  const PngContext context(spng_ctx_new(0), spng_ctx_free);
  const Expected<spng_ihdr> header = open_png(context.get(), bytes, image);
  if (!header) return header.error();
  if (header->bit_depth == 16) {
    return Error{.message = "has 16 bits a channel",
                 .file = image.file,
                 .mend = "colour images have 8 bits a channel"};
  }
  ColorImage color(image.width, image.height);
  if (const int code = spng_decode_image(context.get(), color.pixels().data(),
                                         color.pixels().size_bytes(), SPNG_FMT_RGB8, 0);
      code != 0) {
    return damaged(image, spng_strerror(code));
  }
  return color;
}

Expected<std::string> encoder_failed(const std::string& reason) {
  return Error{.message = "an image could not be encoded: " + reason};
}

}  // namespace

Expected<ColorImage> decode_color(std::string_view bytes, const ExpectedImage& image) {
  return is_jpeg(bytes) ? decode_jpeg(bytes, image) : decode_color_png(bytes, image);
}

Expected<RawDepthImage> decode_depth(std::string_view bytes, const ExpectedImage& image) {
  const PngContext context(spng_ctx_new(0), spng_ctx_free);
  const Expected<spng_ihdr> header = open_png(context.get(), bytes, image);
  if (!header) return header.error();
  if (header->bit_depth != 16 || header->color_type != SPNG_COLOR_TYPE_GRAYSCALE) {
    return Error{.message = "is not a depth image: it has " + std::to_string(header->bit_depth) +
                            " bits a channel" +
                            (header->color_type == SPNG_COLOR_TYPE_GRAYSCALE ? "" : ", in colour"),
                 .file = image.file,
                 .mend = "depth images are PNG files with one channel of 16 bits"};
  }
  RawDepthImage depth(image.width, image.height);
  if (const int code = spng_decode_image(context.get(), depth.pixels().data(),
                                         depth.pixels().size_bytes(), SPNG_FMT_PNG, 0);
      code != 0) {
    return damaged(image, spng_strerror(code));
  }
  return depth;
}

Expected<std::string> encode_color(const ColorImage& image) {
  const JpegHandle handle(tjInitCompress());
  unsigned char* buffer = nullptr;
  unsigned long size = 0;
  const int code = tjCompress2(
      handle.get(), reinterpret_cast<const unsigned char*>(image.pixels().data()), image.width(), 0,
      image.height(), TJPF_RGB, &buffer, &size, TJSAMP_420, kJpegQuality, 0);
  const std::unique_ptr<unsigned char, decltype(&tjFree)> owner(buffer, tjFree);
  if (code != 0) return encoder_failed(tjGetErrorStr2(handle.get()));
  return std::string(reinterpret_cast<const char*>(buffer), size);
}

Expected<std::string> encode_depth(const RawDepthImage& image) {
  const PngContext context(spng_ctx_new(SPNG_CTX_ENCODER), spng_ctx_free);
  spng_set_option(context.get(), SPNG_ENCODE_TO_BUFFER, 1);
  spng_ihdr header{};
  header.width = static_cast<std::uint32_t>(image.width());
  header.height = static_cast<std::uint32_t>(image.height());
  header.bit_depth = 16;
  header.color_type = SPNG_COLOR_TYPE_GRAYSCALE;
  int code = spng_set_ihdr(context.get(), &header);
  if (code == 0) {
    code = spng_encode_image(context.get(), image.pixels().data(), image.pixels().size_bytes(),
                             SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE);
  }
  std::size_t size = 0;
  void* buffer = code == 0 ? spng_get_png_buffer(context.get(), &size, &code) : nullptr;
  const std::unique_ptr<void, decltype(&std::free)> owner(buffer, std::free);
  if (code != 0 || buffer == nullptr) return encoder_failed(spng_strerror(code));
  return std::string(static_cast<const char*>(buffer), size);
}

}  // namespace pcavr
