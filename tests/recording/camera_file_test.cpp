// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recording/camera_file.hpp"

#include <gtest/gtest.h>

#include "recording/camera_keys.hpp"
#include "support/shared_data.hpp"
#include "support/source_folder.hpp"

namespace pcavr {
namespace {

TEST(CameraFile, OfEverySensorShippedIsRead) {
  int files = 0;
  const auto folder = source_folder() / "calib/cameras";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const Expected<CameraFile> camera = read_camera_file(entry.path());
    ASSERT_TRUE(camera.has_value()) << camera.error().to_string();
    EXPECT_TRUE(camera->depth_scale.has_value() && camera->depth_noise.has_value());
    ++files;
  }
  EXPECT_GE(files, 5);
}

TEST(CameraFile, OfRosIsRead) {
  const Expected<CameraFile> camera = parse_camera_file(
      "image_width: 640\nimage_height: 480\ncamera_name: head\n"
      "camera_matrix: {rows: 3, cols: 3, data: [525, 0, 319.5, 0, 524, 239.5, 0, 0, 1]}\n"
      "distortion_model: plumb_bob\n"
      "distortion_coefficients: {rows: 1, cols: 5, data: [0.1, -0.2, 0.001, 0.002, 0]}\n"
      "projection_matrix: {rows: 3, cols: 4, data: []}\n",
      "head.yaml");
  ASSERT_TRUE(camera.has_value()) << camera.error().to_string();
  EXPECT_EQ(camera->name, "head");
  EXPECT_EQ(camera->camera.fy, 524.0);
  EXPECT_EQ(camera->camera.cx, 319.5);
  EXPECT_EQ(camera->camera.distortion[1], -0.2);
}

TEST(CameraFile, WithAnotherLensModelIsRefused) {
  const Expected<CameraFile> camera =
      parse_camera_file("camera_matrix: {data: []}\ndistortion_model: equidistant\n", "c.yaml");
  ASSERT_FALSE(camera.has_value());
  EXPECT_EQ(camera.error().line, 2);
}

TEST(CameraFile, WithAnUnknownKeyNamesItsLine) {
  const Expected<CameraFile> camera = parse_camera_file(
      "name: a\ncamera: {width: 4, height: 3, fx: 1, fy: 1, cx: 0, cy: 0}\nscale: 3\n", "c.yaml");
  ASSERT_FALSE(camera.has_value());
  EXPECT_EQ(camera.error().line, 3);
  EXPECT_EQ(camera.error().file, "c.yaml");
}

}  // namespace
}  // namespace pcavr
