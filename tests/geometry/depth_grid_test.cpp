// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/geometry/depth_grid.hpp"

#include <gtest/gtest.h>

namespace pcavr {
namespace {

CameraModel azure_like_camera() {
  CameraModel camera;
  camera.width = 4096;
  camera.height = 3072;
  camera.fx = 1950.0;
  camera.fy = 1948.0;
  camera.cx = 2041.3;
  camera.cy = 1552.9;
  camera.distortion = {0.08, -0.05, 0.001, -0.002, 0.01};
  return camera;
}

TEST(DepthGrid, AcceptsSizesThatAreSmallerByOneFactor) {
  const CameraModel camera = azure_like_camera();
  EXPECT_TRUE(is_depth_grid(camera, 4096, 3072));
  EXPECT_TRUE(is_depth_grid(camera, 1024, 768));
  EXPECT_TRUE(is_depth_grid(camera, 640, 480));  // by 6.4
  EXPECT_FALSE(is_depth_grid(camera, 640, 576));
  EXPECT_FALSE(is_depth_grid(camera, 8192, 6144));
  EXPECT_FALSE(is_depth_grid(camera, 0, 0));
}

TEST(DepthGrid, APointProjectsToTheSamePlaceOnBothGrids) {
  const CameraModel color = azure_like_camera();
  const Eigen::Vector3d p_camera(0.21, -0.34, 0.9);
  for (const auto& [width, height] : {std::pair(1024, 768), {640, 480}}) {
    const CameraModel depth = on_grid(color, width, height);
    const Eigen::Vector2d pixel = to_grid(color.project(p_camera), color, depth);
    EXPECT_LT((pixel - depth.project(p_camera)).norm(), 1e-9);
    EXPECT_LT((to_grid(pixel, depth, color) - color.project(p_camera)).norm(), 1e-9);
    // The corners of both images are the same rays.
    EXPECT_LT((to_grid({-0.5, -0.5}, color, depth) - Eigen::Vector2d(-0.5, -0.5)).norm(), 1e-12);
    const Eigen::Vector2d far_corner = to_grid({4095.5, 3071.5}, color, depth);
    EXPECT_LT((far_corner - Eigen::Vector2d(width - 0.5, height - 0.5)).norm(), 1e-9);
  }
}

TEST(DepthGrid, AnIntegerFactorGivesTheDownsampledCamera) {
  const CameraModel downsampled = azure_like_camera().downsampled(4);
  const CameraModel depth = on_grid(azure_like_camera(), 1024, 768);
  EXPECT_EQ(depth.width, downsampled.width);
  EXPECT_NEAR(depth.fx, downsampled.fx, 1e-9);
  EXPECT_NEAR(depth.cx, downsampled.cx, 1e-9);
  EXPECT_NEAR(depth.cy, downsampled.cy, 1e-9);
}

TEST(DepthGrid, ColourIsTheMeanOverEachCoarsePixel) {
  // A linear ramp along x: the mean over a span is the value at its centre.
  ColorImage color(64, 32);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 64; ++x) color(x, y) = {static_cast<std::uint8_t>(3 * x), 200, 7};
  }
  for (const auto& [width, height] : {std::pair(16, 8), {10, 5}}) {
    const ColorImage coarse = color_on_grid(color, width, height);
    const double factor = 64.0 / width;
    for (int x = 0; x < width; ++x) {
      EXPECT_NEAR(coarse(x, 2).r, 3.0 * ((x + 0.5) * factor - 0.5), 0.51) << width;
      EXPECT_EQ(coarse(x, 2).g, 200);
      EXPECT_EQ(coarse(x, 2).b, 7);
    }
  }
  const ColorImage same = color_on_grid(color, 64, 32);
  EXPECT_TRUE(std::equal(same.pixels().begin(), same.pixels().end(), color.pixels().begin()));
}

TEST(DepthGrid, DepthForAColourPixelIsTheNearestDepthPixel) {
  DepthImage depth(3, 2);
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 3; ++x) depth(x, y) = static_cast<float>(10 * y + x);
  }
  const DepthImage fine = depth_on_color(depth, 9, 6);
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 9; ++x) EXPECT_EQ(fine(x, y), depth(x / 3, y / 3));
  }
}

}  // namespace
}  // namespace pcavr
