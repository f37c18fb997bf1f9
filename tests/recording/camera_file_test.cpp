// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recording/camera_file.hpp"

#include <gtest/gtest.h>

#include "pcavr/core/output.hpp"

#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

class CameraFileTest : public testing::Test {
 protected:
  [[nodiscard]] Expected<CameraFile> read(const std::string& text) const {
    const std::filesystem::path file = folder_.path() / "camera.yaml";
    EXPECT_TRUE(write_file(file, text).has_value());
    return read_camera_file(file);
  }

  TemporaryFolder folder_;
};

TEST_F(CameraFileTest, EveryFileThatIsShippedIsSound) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(PCAVR_SOURCE_DIR "/calib/cameras")) {
    const Expected<CameraFile> camera = read_camera_file(entry.path());
    ASSERT_TRUE(camera) << camera.error().to_string();
    EXPECT_TRUE(camera->depth_scale) << entry.path();
    ASSERT_TRUE(camera->depth_noise) << entry.path();
    // At a metre every one of these sensors is good to some millimetres.
    EXPECT_GT(camera->depth_noise->sigma(1.0), 0.0005) << entry.path();
    EXPECT_LT(camera->depth_noise->sigma(1.0), 0.006) << entry.path();
    ++files;
  }
  EXPECT_GE(files, 5);
}

TEST_F(CameraFileTest, ReadsRosCameraInfo) {
  const auto camera = read(
      "image_width: 1280\nimage_height: 1024\ncamera_name: rig\n"
      "camera_matrix: {rows: 3, cols: 3, data: [1506.9, 0, 641.2, 0, 1506.3, 524.5, 0, 0, 1]}\n"
      "distortion_model: plumb_bob\n"
      "distortion_coefficients: {rows: 1, cols: 5, data: [-0.23, 0.22, 0.0001, 0, -0.09]}\n");
  ASSERT_TRUE(camera) << camera.error().to_string();
  EXPECT_EQ(camera->camera.width, 1280);
  EXPECT_DOUBLE_EQ(camera->camera.fy, 1506.3);
  EXPECT_DOUBLE_EQ(camera->camera.cx, 641.2);
  EXPECT_DOUBLE_EQ(camera->camera.distortion[4], -0.09);
  EXPECT_FALSE(camera->depth_noise);
}

TEST_F(CameraFileTest, NamesTheLineOfAnUnknownKey) {
  const auto camera =
      read("camera: {width: 640, height: 480, fx: 525, fy: 525, cx: 319.5, cy: 239.5}\nfocus: 3\n");
  ASSERT_FALSE(camera);
  EXPECT_EQ(camera.error().line, 2);
  EXPECT_EQ(camera.error().place, "focus");
}

TEST_F(CameraFileTest, RefusesWhatIsNoCamera) {
  EXPECT_FALSE(read(""));
  EXPECT_FALSE(read("- 1\n- 2\n"));
  EXPECT_FALSE(read("camera: {width: 640}\n"));
  EXPECT_FALSE(read("camera: {width: 640.5, height: 480, fx: 525, fy: 525, cx: 0, cy: 0}\n"));
  EXPECT_FALSE(read("camera: {width: 640, height: 480, fx: 0, fy: 525, cx: 0, cy: 0}\n"));
  EXPECT_FALSE(read("camera: {width: 640, height: 480, fx: .nan, fy: 525, cx: 0, cy: 0}\n"));
  EXPECT_FALSE(read("camera: [unclosed\n"));
  EXPECT_FALSE(read_camera_file(folder_.path() / "absent.yaml"));
}

}  // namespace
}  // namespace pcavr
