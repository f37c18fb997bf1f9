// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/sites/picture_encoder.hpp"

#include <chrono>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <thread>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/recordings/recording/image_codec.hpp"

namespace pcavr {
namespace {

/// Grain that no quality compresses well.
ColorImage grainy(int width, int height) {
  ColorImage image(width, height);
  Random random(7);
  for (Rgb8& pixel : image.pixels()) {
    const auto level = static_cast<std::uint8_t>(random.below(256));
    pixel = {level, level, static_cast<std::uint8_t>(255 - level)};
  }
  return image;
}

TEST(EncodePicture, IsOfFullSizeAndQualityWhereThereIsRoom) {
  int quality = 90;
  const auto picture = encode_picture({2.5, ColorImage(640, 480)}, 100'000, quality);
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->t, 2.5);
  EXPECT_EQ(picture->width, 640);
  EXPECT_EQ(picture->height, 480);
  EXPECT_EQ(quality, 90);
}

TEST(EncodePicture, IsCoarserAndThenSmallerWhereThereIsLess) {
  const CameraPicture picture{0.0, grainy(641, 480)};
  int quality = 90;
  const auto coarse = encode_picture(picture, 250'000, quality);
  ASSERT_TRUE(coarse);
  EXPECT_EQ(coarse->width, 641);
  EXPECT_LT(quality, 90);
  EXPECT_LE(coarse->jpeg.size(), 250'000U);
  const auto small = encode_picture(picture, 15'000, quality);
  ASSERT_TRUE(small);
  EXPECT_LE(small->jpeg.size(), 15'000U);
  EXPECT_LT(small->width, 641);
  ImageDecoder decoder;
  const std::string_view bytes(reinterpret_cast<const char*>(small->jpeg.data()),
                               small->jpeg.size());
  EXPECT_TRUE(decoder.color(bytes, {"picture", small->width, small->height}));
}

TEST(EncodePicture, HasTheCameraOfTheSmallerPicture) {
  const CameraModel camera{.width = 640,
                           .height = 480,
                           .fx = 600.0,
                           .fy = 602.0,
                           .cx = 319.5,
                           .cy = 239.5,
                           .distortion = {0.1, -0.05, 0.001, 0.0, 0.0}};
  int quality = 90;
  const auto small = encode_picture({0.0, grainy(640, 480), camera}, 15'000, quality);
  ASSERT_TRUE(small);
  ASSERT_LT(small->width, 640);
  ASSERT_TRUE(small->camera);
  const double ratio = 640.0 / small->width;
  EXPECT_NEAR(small->camera->fx, 600.0 / ratio, 1e-3);
  EXPECT_NEAR(small->camera->fy, 602.0 / ratio, 1e-3);
  EXPECT_NEAR(small->camera->cx, (319.5 + 0.5) / ratio - 0.5, 1e-3);
  EXPECT_EQ(small->camera->lens, LensModel::plumb_bob);
  EXPECT_EQ(small->camera->coefficients[1], -0.05F);
  EXPECT_FALSE(encode_picture({0.0, ColorImage(64, 48)}, 15'000, quality)->camera);
}

TEST(EncodePicture, EndsWithTheCoarsestOne) {
  int quality = 90;
  const auto picture = encode_picture({0.0, grainy(640, 480)}, 200, quality);
  ASSERT_TRUE(picture);
  EXPECT_GE(picture->width, 80);
  EXPECT_LT(picture->width, 160);
}

TEST(EncodePicture, RecoversItsQuality) {
  int quality = 20;
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(encode_picture({0.0, ColorImage(64, 48)}, 100'000, quality));
  }
  EXPECT_EQ(quality, 90);
}

/// A camera of 100 Hz that fails at one time.
class Camera final : public PictureSource {
 public:
  [[nodiscard]] Expected<std::optional<CameraPicture>> newest(double t) override {
    if (t == 3.0) return Error{.message = "the lens fell off"};
    if (t == 3.5) throw std::runtime_error("the driver failed");
    if (last_ == t) return std::optional<CameraPicture>();
    last_ = t;
    return std::optional(CameraPicture{t, ColorImage(64, 48)});
  }

 private:
  std::optional<double> last_;
};

template <typename Take>
auto wait_for(Take take) {
  auto taken = take();
  for (int i = 0; i < 2000 && !taken; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    taken = take();
  }
  return taken;
}

TEST(PictureEncoder, GivesWhatWasAskedForOnceAndSaysWhatFailed) {
  Camera camera;
  PictureEncoder encoder(camera);
  EXPECT_FALSE(encoder.take());
  encoder.request(1.0, 10'000);
  const auto picture = wait_for([&] { return encoder.take(); });
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->t, 1.0);
  EXPECT_FALSE(encoder.take());
  encoder.request(3.0, 10'000);
  const auto fault = wait_for([&] { return encoder.take_fault(); });
  ASSERT_TRUE(fault);
  EXPECT_NE(fault->find("lens"), std::string::npos);
  encoder.request(3.5, 10'000);
  const auto thrown = wait_for([&] { return encoder.take_fault(); });
  ASSERT_TRUE(thrown);
  EXPECT_NE(thrown->find("the driver failed"), std::string::npos);
  encoder.request(4.0, 10'000);
  EXPECT_TRUE(wait_for([&] { return encoder.take(); }));
}

}  // namespace
}  // namespace pcavr
