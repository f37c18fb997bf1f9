// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/camera_file.hpp"

#include <gtest/gtest.h>

#include "recordings/recording/camera_keys.hpp"
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

TEST(CameraFile, OfRosCameraInfoIsRead) {
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
  EXPECT_EQ(camera->camera.distortion.coefficients()[1], -0.2);
}

/// ROS camera_info with another model and other coefficients.
std::string camera_info(const std::string& model, const std::string& coefficients) {
  return "image_width: 640\nimage_height: 480\n"
         "camera_matrix: {rows: 3, cols: 3, data: [525, 0, 319.5, 0, 524, 239.5, 0, 0, 1]}\n"
         "distortion_model: " +
         model +
         "\n"
         "distortion_coefficients: {rows: 1, data: [" +
         coefficients + "]}\n";
}

TEST(CameraFile, OfRosWithEachLensModelIsRead) {
  const Expected<CameraFile> rational =
      parse_camera_file(camera_info("rational_polynomial",
                                    "0.5285, -2.68, 0.0005, -0.0002, 1.51, 0.4095, -2.5, 1.44"),
                        "c.yaml");
  ASSERT_TRUE(rational.has_value()) << rational.error().to_string();
  EXPECT_EQ(rational->camera.distortion.model(), LensModel::rational);
  EXPECT_EQ(rational->camera.distortion.coefficients()[7], 1.44);
  const Expected<CameraFile> fisheye =
      parse_camera_file(camera_info("equidistant", "-0.0117, 0.0301, -0.0274, 0.0079"), "c.yaml");
  ASSERT_TRUE(fisheye.has_value()) << fisheye.error().to_string();
  EXPECT_EQ(fisheye->camera.distortion.model(), LensModel::fisheye);
}

TEST(CameraFile, WithAnUnknownLensModelIsRefused) {
  const Expected<CameraFile> camera = parse_camera_file(camera_info("thin_prism", "0"), "c.yaml");
  ASSERT_FALSE(camera.has_value());
  EXPECT_EQ(camera.error().line, 4);
}

TEST(CameraFile, WithALensThatFoldsIsRefused) {
  const Expected<CameraFile> camera =
      parse_camera_file(camera_info("plumb_bob", "0.5285, -2.68, 0.0005, -0.0002, 1.51"), "c.yaml");
  ASSERT_FALSE(camera.has_value());
  EXPECT_EQ(camera.error().line, 5);
  EXPECT_EQ(camera.error().place, "distortion_coefficients.data");
}

TEST(CameraFile, WithImpossibleIntrinsicsIsRefused) {
  std::string text = camera_info("plumb_bob", "0, 0, 0, 0, 0");
  const Expected<CameraFile> camera =
      parse_camera_file(text.replace(text.find("525"), 3, "1e-300"), "c.yaml");
  ASSERT_FALSE(camera.has_value());
  EXPECT_EQ(camera.error().line, 3);
}

TEST(CameraFile, OfItsOwnKeysNamesTheLensModel) {
  const Expected<CameraFile> camera = parse_camera_file(
      "camera:\n  {width: 640, height: 480, fx: 300, fy: 300, cx: 320, cy: 240,\n"
      "   model: fisheye, distortion: [0, 0, 0, 0]}\n",
      "c.yaml");
  ASSERT_TRUE(camera.has_value()) << camera.error().to_string();
  EXPECT_EQ(camera->camera.distortion.model(), LensModel::fisheye);
}

TEST(CameraFile, WithDepthThatNoSensorReachesIsRefused) {
  const Expected<CameraFile> camera = parse_camera_file(
      "camera: {width: 640, height: 480, fx: 525, fy: 525, cx: 320, cy: 240}\n"
      "depth_noise: {constant: 0.001, quadratic: 0.002, offset: 0.4, grazing: 0.0001,\n"
      "              nearest: 0.4, farthest: 1e9}\n",
      "c.yaml");
  ASSERT_FALSE(camera.has_value());
  EXPECT_EQ(camera.error().line, 3);
  EXPECT_EQ(camera.error().place, "depth_noise.farthest");
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
