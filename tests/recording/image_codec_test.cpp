// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/image_codec.hpp"

#include <algorithm>
#include <cstdlib>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

namespace pcavr {
namespace {

const ExpectedImage kSmall{"image", 7, 5};

RawDepthImage random_depth(std::uint64_t seed) {
  Random random(seed);
  RawDepthImage depth(7, 5);
  for (std::uint16_t& pixel : depth.pixels()) {
    pixel = static_cast<std::uint16_t>(random.below(65536));
  }
  return depth;
}

/// Applies a PNG filter to plain rows, after the formulas of ISO/IEC 15948, table 9.1.
PngImage filtered(const PngImage& plain, std::uint8_t filter) {
  PngImage image = plain;
  const auto size = static_cast<int>(plain.row_size());
  const auto back = static_cast<int>(plain.pixel_size());
  for (int y = 0; y < plain.height; ++y) {
    std::uint8_t* row = image.rows.data() + y * (size + 1);
    row[0] = filter;
    for (int x = 0; x < size; ++x) {
      const int a = x >= back ? plain.row(y)[x - back] : 0;
      const int b = y > 0 ? plain.row(y - 1)[x] : 0;
      const int c = x >= back && y > 0 ? plain.row(y - 1)[x - back] : 0;
      const int p = a + b - c;
      int paeth = a;
      if (std::abs(p - b) < std::abs(p - paeth)) paeth = b;
      if (std::abs(p - c) < std::abs(p - paeth)) paeth = c;
      const int predictions[] = {0, a, b, (a + b) / 2, paeth};
      row[x + 1] = static_cast<std::uint8_t>(plain.row(y)[x] - predictions[filter]);
    }
  }
  return image;
}

PngImage random_png(int bit_depth, int channels) {
  Random random(static_cast<std::uint64_t>(bit_depth * 10 + channels));
  PngImage image{.width = 7, .height = 5, .bit_depth = bit_depth, .channels = channels};
  image.rows.resize(5 * (image.row_size() + 1));
  for (std::size_t i = 0; i < image.rows.size(); ++i) {
    const bool is_filter = i % (image.row_size() + 1) == 0;
    image.rows[i] = is_filter ? 0 : static_cast<std::uint8_t>(random.below(256));
  }
  return image;
}

TEST(DepthPng, IsLossless) {
  ImageDecoder decoder;
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const RawDepthImage depth = random_depth(seed);
    const auto again = decoder.raw_depth(encode_depth(depth), kSmall);
    ASSERT_TRUE(again.has_value()) << again.error().to_string();
    EXPECT_TRUE(std::ranges::equal(again->pixels(), depth.pixels()));
  }
}

TEST(ColorPng, IsLossless) {
  Random random(6);
  ColorImage color(kSmall.width, kSmall.height);
  for (Rgb8& pixel : color.pixels()) {
    pixel = {static_cast<std::uint8_t>(random.below(256)),
             static_cast<std::uint8_t>(random.below(256)),
             static_cast<std::uint8_t>(random.below(256))};
  }
  ImageDecoder decoder;
  const auto again = decoder.color(encode_color_png(color), kSmall);
  ASSERT_TRUE(again.has_value()) << again.error().to_string();
  EXPECT_TRUE(std::ranges::equal(again->pixels(), color.pixels()));
}

TEST(Png, IsTheSameThroughEveryFilterAndPixelSize) {
  for (const int bit_depth : {8, 16}) {
    for (const int channels : {1, 2, 3, 4}) {
      const PngImage plain = random_png(bit_depth, channels);
      for (std::uint8_t filter = 0; filter < 5; ++filter) {
        PngImage decoded;
        ASSERT_TRUE(decode_png(encode_png(filtered(plain, filter)), decoded).has_value());
        EXPECT_EQ(decoded.rows, plain.rows)
            << bit_depth << " bits, " << channels << " channels, filter " << int{filter};
      }
    }
  }
}

TEST(Png, WithAnUnknownFilterIsRefused) {
  PngImage image = random_png(8, 1);
  image.rows[0] = 5;
  PngImage decoded;
  EXPECT_FALSE(decode_png(encode_png(image), decoded).has_value());
}

TEST(DepthPng, TruncatedAnywhereIsRefused) {
  const std::string whole = encode_depth(random_depth(4));
  ImageDecoder decoder;
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(decoder.raw_depth(whole.substr(0, size), kSmall).has_value()) << size;
  }
}

TEST(DepthPng, WithAnyByteChangedIsRefused) {
  const std::string whole = encode_depth(random_depth(5));
  ImageDecoder decoder;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string changed = whole;
    changed[i] = static_cast<char>(changed[i] ^ 0x10);
    EXPECT_FALSE(decoder.raw_depth(changed, kSmall).has_value()) << i;
  }
}

TEST(DepthPng, OfEightBitsIsRefusedByName) {
  ImageDecoder decoder;
  const auto depth = decoder.raw_depth(encode_png(random_png(8, 1)), kSmall);
  ASSERT_FALSE(depth.has_value());
  EXPECT_EQ(depth.error().message, "is not a depth image: it has 1 channels of 8 bits");
  EXPECT_EQ(depth.error().file, "image");
}

TEST(DepthPng, OfAnotherSizeIsRefusedBeforeItAllocates) {
  ImageDecoder decoder;
  const auto depth = decoder.raw_depth(encode_depth(RawDepthImage(8, 5)), kSmall);
  ASSERT_FALSE(depth.has_value());
  EXPECT_EQ(depth.error().message, "is 8 x 5 pixels, not 7 x 5");
}

TEST(ColorPng, KeepsItsPixelsAndDropsAlpha) {
  ImageDecoder decoder;
  const PngImage png = random_png(8, 4);
  const auto color = decoder.color(encode_png(png), kSmall);
  ASSERT_TRUE(color.has_value()) << color.error().to_string();
  const std::uint8_t* third = png.row(2) + 3 * 4;
  EXPECT_EQ((*color)(3, 2), (Rgb8{third[0], third[1], third[2]}));
}

TEST(ColorPng, OfGrayHasEqualChannels) {
  ImageDecoder decoder;
  const PngImage png = random_png(8, 1);
  const auto color = decoder.color(encode_png(png), kSmall);
  ASSERT_TRUE(color.has_value());
  EXPECT_EQ((*color)(6, 4), (Rgb8{png.row(4)[6], png.row(4)[6], png.row(4)[6]}));
}

TEST(ColorPng, OfSixteenBitsIsRefused) {
  ImageDecoder decoder;
  EXPECT_FALSE(decoder.color(encode_png(random_png(16, 3)), kSmall).has_value());
}

TEST(ColorJpeg, RoundTripIsAlmostLossless) {
  ColorImage ramp(32, 16);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 32; ++x) ramp(x, y) = {static_cast<std::uint8_t>(8 * x), 100, 50};
  }
  ImageDecoder decoder;
  const Expected<std::string> bytes = encode_color(ramp);
  ASSERT_TRUE(bytes.has_value());
  const auto again = decoder.color(*bytes, {"image", 32, 16});
  ASSERT_TRUE(again.has_value()) << again.error().to_string();
  for (int y = 0; y < 16; ++y) {
    // Luma is preserved to about 2 levels at quality 95; 4:2:0 chroma blurs red over two pixels.
    for (int x = 0; x < 32; ++x) EXPECT_NEAR((*again)(x, y).r, ramp(x, y).r, 12);
  }
}

TEST(ColorJpeg, TruncatedIsRefused) {
  const Expected<std::string> bytes = encode_color(ColorImage(64, 64, Rgb8{10, 200, 30}));
  ASSERT_TRUE(bytes.has_value());
  ImageDecoder decoder;
  for (const std::size_t missing : {std::size_t{3}, bytes->size() / 2, bytes->size() - 3}) {
    const auto color = decoder.color(bytes->substr(0, bytes->size() - missing), {"image", 64, 64});
    EXPECT_FALSE(color.has_value()) << missing << " bytes missing";
  }
}

}  // namespace
}  // namespace pcavr
