// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/bag_import/camera_images.hpp"

#include <bit>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/recording/image_codec.hpp"

#include "support/read_bag.hpp"

namespace pcavr {
namespace {

RosImage image_of(const std::string& encoding, int width, int height, const std::string& pixels) {
  RosImage image;
  image.width = width;
  image.height = height;
  image.encoding = encoding;
  image.step = static_cast<std::uint32_t>(pixels.size()) / static_cast<std::uint32_t>(height);
  image.data = test::bytes_of(pixels);
  return image;
}

template <typename Number>
std::string raw_bytes(const std::vector<Number>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), sizeof(Number) * numbers.size()};
}

RawDepthImage decoded_depth(const ConvertedImage& image) {
  ImageDecoder decoder;
  const auto depth = decoder.raw_depth(image.file.bytes,
                                       {.file = "d", .width = image.width, .height = image.height});
  EXPECT_TRUE(depth) << (depth ? "" : depth.error().to_string());
  return depth ? *depth : RawDepthImage();
}

TEST(CameraImages, DepthInMetresAndMillimetres) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::string metres = raw_bytes<float>({1.0F, nan, -1.0F, 2.5F});
  const auto metric = convert_depth(image_of("32FC1", 2, 2, metres), 5000.0);
  ASSERT_TRUE(metric);
  const RawDepthImage units = decoded_depth(*metric);
  EXPECT_EQ(units(0, 0), 5000);
  EXPECT_EQ(units(1, 0), 0);
  EXPECT_EQ(units(0, 1), 0);
  EXPECT_EQ(units(1, 1), 12500);
  // Rows may have padding, and the other byte order.
  const std::string padded("\x01\x02\x03\x04zz\x05\x06\x07\x08zz", 12);
  RosImage image = image_of("16UC1", 2, 2, padded);
  EXPECT_EQ(decoded_depth(*convert_depth(image, 5000.0))(1, 1), 0x0807);
  image.is_big_endian = true;
  EXPECT_EQ(decoded_depth(*convert_depth(image, 5000.0))(1, 1), 0x0708);
}

TEST(CameraImages, CompressedDepth) {
  RawDepthImage values(2, 1);
  values(0, 0) = 1234;
  values(1, 0) = 0;
  const auto message = [](const std::string& format, const std::string& data) {
    RosCompressedImage compressed;
    compressed.format = format;
    compressed.data = test::bytes_of(data);
    return RosMessage(compressed);
  };
  const std::string plain = std::string(12, '\0') + encode_depth(values);
  const auto millimetres = convert_depth(message("16UC1; compressedDepth png", plain), 5000.0);
  ASSERT_TRUE(millimetres);
  EXPECT_EQ(decoded_depth(*millimetres)(0, 0), 1234);
  // value = a / z + b: z = 1000 / (1234 - 234) = 1 m.
  const std::string inverse =
      std::string(4, '\0') + raw_bytes<float>({1000.0F, 234.0F}) + encode_depth(values);
  const auto metric = convert_depth(message("32FC1; compressedDepth", inverse), 5000.0);
  ASSERT_TRUE(metric);
  EXPECT_EQ(decoded_depth(*metric)(0, 0), 5000);
  EXPECT_EQ(decoded_depth(*metric)(1, 0), 0);
  EXPECT_FALSE(convert_depth(message("16UC1; compressedDepth rvl", plain.substr(0, 40)), 5000.0));
  EXPECT_FALSE(convert_depth(message("16UC1; compressedDepth png", "short"), 5000.0));
}

TEST(CameraImages, ColourInEveryOrderOfChannels) {
  const std::pair<const char*, std::string> kPixels[] = {{"rgb8", "\xC8\x64\x32"},
                                                         {"bgr8", "\x32\x64\xC8"},
                                                         {"rgba8", "\xC8\x64\x32\xFF"},
                                                         {"bgra8", "\x32\x64\xC8\xFF"}};
  for (const auto& [encoding, pixel] : kPixels) {
    std::string pixels;
    for (int i = 0; i < 64; ++i) pixels += pixel;
    const auto image = convert_color(image_of(encoding, 8, 8, pixels));
    ASSERT_TRUE(image) << encoding;
    ImageDecoder decoder;
    const auto color = decoder.color(image->file.bytes, {.file = "c", .width = 8, .height = 8});
    ASSERT_TRUE(color);
    EXPECT_NEAR((*color)(4, 4).r, 200, 3) << encoding;
    EXPECT_NEAR((*color)(4, 4).b, 50, 3) << encoding;
    // The same image as a message of JPEG is taken unchanged, with its size.
    RosCompressedImage compressed;
    compressed.data = test::bytes_of(image->file.bytes);
    const auto same = convert_color(RosMessage(compressed));
    ASSERT_TRUE(same);
    EXPECT_EQ(same->file.bytes, image->file.bytes);
    EXPECT_EQ(same->width, 8);
  }
  EXPECT_FALSE(convert_color(image_of("bayer_rggb8", 2, 2, "abcd")));
  EXPECT_FALSE(convert_color(image_of("rgb8", 8, 1, "too short")));
}

TEST(CameraImages, CamerasWithTheLensModelsOfRos) {
  RosCameraInfo info;
  info.width = 640;
  info.height = 480;
  info.intrinsics << 500, 0, 320, 0, 501, 240, 0, 0, 1;
  info.projection.setZero();
  info.projection(0, 0) = info.projection(1, 1) = 490.0;
  info.distortion_model = "plumb_bob";
  info.distortion = {0.1, -0.05, 0.001, 0.002, 0.01};
  const auto camera = camera_of(info, false);
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->fy, 501.0);
  EXPECT_TRUE(camera->has_distortion());
  const auto rectified = camera_of(info, true);
  ASSERT_TRUE(rectified);
  EXPECT_EQ(rectified->fx, 490.0);
  EXPECT_FALSE(rectified->has_distortion());
  info.distortion_model = "equidistant";
  EXPECT_FALSE(camera_of(info, false)) << "five coefficients";
  info.distortion.resize(4);
  EXPECT_EQ(camera_of(info, false)->distortion.model(), LensModel::fisheye);
  info.intrinsics(0, 0) = 0.0;
  EXPECT_FALSE(camera_of(info, false));
}

}  // namespace
}  // namespace pcavr
