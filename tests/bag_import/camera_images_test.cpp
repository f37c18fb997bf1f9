// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/bag_import/camera_images.hpp"

#include <bit>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/recordings/recording/image_codec.hpp"

#include "support/read_bag.hpp"

namespace pcavr {
namespace {

/// `pixels` must outlive it: literals do.
RosImage image_of(const std::string& encoding, int width, int height, std::string_view pixels) {
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
  EXPECT_FALSE(convert_color(image_of("bayer_rggb16", 2, 2, "abcdefgh")));
  EXPECT_FALSE(convert_color(image_of("rgb8", 8, 1, "too short")));
}

Rgb8 decoded_pixel(const RosImage& image, int x, int y) {
  const auto color = decode_color(image, image.width, image.height);
  EXPECT_TRUE(color) << image.encoding << (color ? "" : color.error().to_string());
  return color ? (*color)(x, y) : Rgb8{};
}

/// A scene of one colour has that colour everywhere, whatever the pattern; at an edge between two
/// each pixel keeps what it has measured.
TEST(CameraImages, BayerPatterns) {
  for (const std::string pattern : {"rggb", "bggr", "gbrg", "grbg"}) {
    std::string pixels;
    for (int y = 0; y < 6; ++y) {
      for (int x = 0; x < 8; ++x) {
        const char channel = pattern[static_cast<std::size_t>(2 * (y % 2) + x % 2)];
        const int right = x < 4 ? 0 : 20;
        pixels += static_cast<char>((channel == 'r' ? 100 : channel == 'g' ? 60 : 30) + right);
      }
    }
    const RosImage image = image_of("bayer_" + pattern + "8", 8, 6, pixels);
    for (const int x : {0, 7}) {
      const Rgb8 color = decoded_pixel(image, x, x == 0 ? 0 : 5);
      const int right = x < 4 ? 0 : 20;
      EXPECT_EQ(color.r, 100 + right) << pattern << x;
      EXPECT_EQ(color.g, 60 + right) << pattern << x;
      EXPECT_EQ(color.b, 30 + right) << pattern << x;
    }
    const Rgb8 edge = decoded_pixel(image, 3, 2);
    EXPECT_EQ(pattern[1] == 'r'   ? edge.r
              : pattern[1] == 'g' ? edge.g
                                  : edge.b,
              pattern[1] == 'r'   ? 100
              : pattern[1] == 'g' ? 60
                                  : 30);
  }
  // A single column has no red: nothing is read beyond it.
  EXPECT_EQ(decoded_pixel(image_of("bayer_bggr8", 1, 2, "ab"), 0, 0).r, 0);
}

/// Y, U, V of ITU-R BT.601 of red (255, 0, 0), and of grey with another luma in each pixel.
TEST(CameraImages, Yuv422InBothOrders) {
  for (const char* name : {"yuv422", "uyvy"}) {
    const RosImage red = image_of(name, 2, 1, "\x5A\x51\xF0\x51");
    EXPECT_NEAR(decoded_pixel(red, 1, 0).r, 255, 2);
    EXPECT_NEAR(decoded_pixel(red, 1, 0).b, 0, 2);
  }
  for (const char* name : {"yuv422_yuy2", "yuyv"}) {
    const RosImage red = image_of(name, 2, 1, "\x51\x5A\x51\xF0");
    EXPECT_NEAR(decoded_pixel(red, 0, 0).r, 255, 2);
    EXPECT_NEAR(decoded_pixel(red, 0, 0).g, 0, 2);
    const RosImage grey = image_of(name, 2, 1, "\x51\x80\xA2\x80");
    EXPECT_NEAR(decoded_pixel(grey, 0, 0).g, 76, 1);
    EXPECT_NEAR(decoded_pixel(grey, 1, 0).g, 170, 1);
  }
  RosImage odd = image_of("yuyv", 1, 1, "\x51\x80");
  EXPECT_FALSE(decode_color(odd, 1, 1)) << "lacks the second half of its pair";
}

TEST(CameraImages, ChannelsWithoutAStatedOrderAreThoseOfOpenCv) {
  EXPECT_EQ(decoded_pixel(image_of("8UC3", 1, 1, "\x01\x02\x03"), 0, 0).r, 3);
  EXPECT_EQ(decoded_pixel(image_of("8UC4", 1, 1, "\x01\x02\x03\x04"), 0, 0).b, 1);
  EXPECT_EQ(decoded_pixel(image_of("8UC1", 1, 1, "\x09"), 0, 0).g, 9);
}

TEST(CameraImages, SizesOfCompressedImagesAreThoseOfTheirHeaders) {
  RosCompressedImage message;
  EXPECT_EQ(image_size(message), ImageSize{});
  const std::string pixels(128, 'x');
  const RosImage raw = image_of("mono8", 16, 8, pixels);
  const auto jpeg = convert_color(raw);
  ASSERT_TRUE(jpeg);
  message.data = test::bytes_of(jpeg->file.bytes);
  EXPECT_EQ(image_size(message), (ImageSize{16, 8}));
  const std::string depth = std::string(12, '\0') + encode_depth(RawDepthImage(4, 2));
  message.format = "16UC1; compressedDepth png";
  message.data = test::bytes_of(depth);
  EXPECT_EQ(image_size(message), (ImageSize{4, 2}));
}

RosCameraInfo full_sensor_info() {
  RosCameraInfo info;
  info.width = 640;
  info.height = 480;
  info.intrinsics << 525, 0, 319.5, 0, 525, 239.5, 0, 0, 1;
  info.projection.setZero();
  info.projection.leftCols<3>() = info.intrinsics;
  return info;
}

void expect_camera(const Expected<CameraModel>& camera, ImageSize size, double fx, double cx,
                   double cy) {
  ASSERT_TRUE(camera) << camera.error().to_string();
  EXPECT_EQ((ImageSize{camera->width, camera->height}), size);
  EXPECT_EQ(camera->fx, fx);
  EXPECT_EQ(camera->cx, cx);
  EXPECT_EQ(camera->cy, cy);
}

TEST(CameraImages, CamerasOfARegionOfTheSensor) {
  constexpr ImageSize kHalf{320, 240};
  RosCameraInfo info = full_sensor_info();
  info.region_x = 160;
  info.region_y = 120;
  info.region_width = 320;
  info.region_height = 240;
  for (const bool is_rectified : {false, true}) {
    expect_camera(camera_of(info, is_rectified, kHalf), kHalf, 525, 159.5, 119.5);
    expect_camera(camera_of(info, is_rectified), kHalf, 525, 159.5, 119.5);
  }
  // Drivers that state the image's size, with the matrix of the sensor or of the image.
  RosCameraInfo of_image = info;
  of_image.width = 320;
  of_image.height = 240;
  expect_camera(camera_of(of_image, false, kHalf), kHalf, 525, 159.5, 119.5);
  expect_camera(camera_of(of_image, false), kHalf, 525, 159.5, 119.5);
  of_image.intrinsics(0, 2) = 161.0;
  of_image.intrinsics(1, 2) = 118.0;
  expect_camera(camera_of(of_image, false, kHalf), kHalf, 525, 161, 118);
  // The corner of the sensor: the principal point lies outside, which only the full size proves.
  info.region_x = 320;
  info.region_y = 240;
  expect_camera(camera_of(info, false, kHalf), kHalf, 525, -0.5, -0.5);
  info.width = 320;
  info.height = 240;
  const auto uncertain = camera_of(info, false, kHalf);
  ASSERT_FALSE(uncertain);
  EXPECT_NE(uncertain.error().message.find("region of interest 320 x 240 at 320, 240"),
            std::string::npos);
  const auto other = camera_of(info, false, {100, 100});
  ASSERT_FALSE(other);
  EXPECT_NE(other.error().message.find("but the images have 100 x 100"), std::string::npos);
  // All of the sensor, stated as a region.
  RosCameraInfo whole = full_sensor_info();
  whole.region_width = 640;
  whole.region_height = 480;
  expect_camera(camera_of(whole, false, {640, 480}), {640, 480}, 525, 319.5, 239.5);
}

TEST(CameraImages, CamerasOfBinnedImages) {
  constexpr ImageSize kHalf{320, 240};
  RosCameraInfo info = full_sensor_info();
  info.binning_x = info.binning_y = 2;
  expect_camera(camera_of(info, false, kHalf), kHalf, 262.5, 159.75, 119.75);
  expect_camera(camera_of(info, false), kHalf, 262.5, 159.75, 119.75);
  info.width = 320;
  info.height = 240;
  expect_camera(camera_of(info, false, kHalf), kHalf, 262.5, 159.75, 119.75);
  // Already those of the image.
  info.intrinsics << 262.5, 0, 159.75, 0, 262.5, 119.75, 0, 0, 1;
  expect_camera(camera_of(info, false, kHalf), kHalf, 262.5, 159.75, 119.75);
  // A binned region.
  RosCameraInfo region = full_sensor_info();
  region.binning_x = region.binning_y = 2;
  region.region_x = 160;
  region.region_y = 120;
  region.region_width = 320;
  region.region_height = 240;
  expect_camera(camera_of(region, false, {160, 120}), {160, 120}, 262.5, 79.75, 59.75);
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
