// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/geometry/camera.hpp"

#include <gtest/gtest.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/random.hpp"

namespace pcavr {
namespace {

CameraModel camera_with_distortion(const LensDistortion& distortion) {
  return {.width = 640,
          .height = 480,
          .fx = 525.0,
          .fy = 520.0,
          .cx = 319.5,
          .cy = 239.5,
          .distortion = distortion};
}

TEST(CameraModel, ProjectsTheAxisToThePrincipalPoint) {
  const CameraModel camera = camera_with_distortion({0.1, -0.2, 0.001, 0.002, 0.05});
  EXPECT_EQ(camera.project({0, 0, 2}), Eigen::Vector2d(319.5, 239.5));
}

TEST(CameraModel, ProjectsByThePlumbBobFormula) {
  // x = 0.5, y = 0: r2 = 0.25, radial 1 + 0.1 * 0.25, tangential p2 (r2 + 2 x^2) = 0.01 * 0.75.
  const CameraModel camera = camera_with_distortion({0.1, 0, 0, 0.01, 0});
  const double x = 0.5 * 1.025 + 0.0075;
  EXPECT_NEAR(camera.project({1, 0, 2}).x(), 525.0 * x + 319.5, 1e-9);
  EXPECT_NEAR(camera.project({1, 0, 2}).y(), 239.5, 1e-9);
}

TEST(CameraModel, UnprojectUndoesProject) {
  Random random(1);
  // No distortion; a Kinect's [TUM RGB-D, freiburg1]; a wide lens with all terms.
  for (const LensDistortion& distortion : {LensDistortion(),
                                           {0.2624, -0.9531, -0.0054, 0.0026, 1.1633},
                                           {-0.28, 0.07, 0.0002, -0.0005, -0.005}}) {
    const CameraModel camera = camera_with_distortion(distortion);
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector2d pixel(random.uniform(0, 639), random.uniform(0, 479));
      const Eigen::Vector3d p_camera = camera.unproject(pixel, random.uniform(0.3, 5.0));
      EXPECT_LT((camera.project(p_camera) - pixel).norm(), 1e-8);
    }
  }
}

TEST(CameraModel, ContainsTheWholeAreaOfEachPixel) {
  const CameraModel camera = camera_with_distortion({});
  EXPECT_TRUE(camera.contains({-0.5, -0.5}));
  EXPECT_TRUE(camera.contains({639.4, 479.4}));
  EXPECT_FALSE(camera.contains({639.5, 0}));
  EXPECT_FALSE(camera.contains({0, -0.6}));
}

TEST(CameraModel, DownsampledIsBinned) {
  const CameraModel camera = camera_with_distortion({0.1, 0, 0, 0, 0});
  const CameraModel half = camera.downsampled(2);
  EXPECT_EQ(half.width, 320);
  const Eigen::Vector3d p_camera(0.3, -0.2, 1.5);
  const Eigen::Vector2d pixel = camera.project(p_camera);
  // Pixels 2 u and 2 u + 1 are averaged into pixel u: their centre, 2 u + 0.5, maps to u.
  EXPECT_LT((half.project(p_camera) - (pixel - Eigen::Vector2d(0.5, 0.5)) / 2).norm(), 1e-9);
  EXPECT_THROW((void)camera.downsampled(0), ContractError);
}

TEST(CameraModel, JacobianIsTheDerivativeOfProject) {
  const std::array<double, 4> fisheye = {0.05, -0.02, 0.01, -0.003};
  for (const LensDistortion& distortion :
       {LensDistortion(), LensDistortion(-0.28, 0.07, 0.002, -0.005, -0.005),
        LensDistortion(LensModel::fisheye, fisheye)}) {
    const CameraModel camera = camera_with_distortion(distortion);
    const Eigen::Vector3d p_camera(0.4, -0.3, 1.1);
    const Eigen::Matrix<double, 2, 3> jacobian = camera.projection_jacobian(p_camera);
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d step = 1e-6 * Eigen::Vector3d::Unit(axis);
      const Eigen::Vector2d difference =
          (camera.project(p_camera + step) - camera.project(p_camera - step)) / 2e-6;
      EXPECT_LT((jacobian.col(axis) - difference).norm(), 1e-5);
    }
  }
}

// Found in users' recordings: the first five of a rational lens's eight coefficients.
TEST(FindFold, FindsALensThatFoldsInsideTheImage) {
  for (const LensDistortion& distortion :
       {LensDistortion(0.5285, -2.68, 0.0005, -0.0002, 1.51), LensDistortion(-1, 0, 0, 0, 0),
        LensDistortion(1e300, 0, 0, 0, 0), LensDistortion(0, 0, 3, 0, 0)}) {
    const CameraModel camera = camera_with_distortion(distortion);
    const std::optional<LensFold> fold = find_fold(camera);
    ASSERT_TRUE(fold);
    EXPECT_TRUE(fold->is_fold);
    EXPECT_TRUE(camera.contains(fold->pixel) || fold->pixel.x() == 639.5 ||
                fold->pixel.y() == 479.5);
  }
  // 1 - 3 r^2 is 0 at r = 0.577, where the image is 0.385 focal lengths wide.
  const CameraModel camera = camera_with_distortion({-1, 0, 0, 0, 0});
  EXPECT_NEAR(std::tan(find_fold(camera)->max_angle), 0.577, 0.005);
  EXPECT_NEAR((find_fold(camera)->pixel - Eigen::Vector2d(319.5, 239.5)).norm(), 0.385 * 522, 12.0);
}

TEST(FindFold, AcceptsALensThatFoldsOutsideTheImageOnly) {
  EXPECT_FALSE(find_fold(camera_with_distortion({})));
  EXPECT_FALSE(find_fold(camera_with_distortion({0.2624, -0.9531, -0.0054, 0.0026, 1.1633})));
  EXPECT_FALSE(find_fold(camera_with_distortion({-0.28, 0.07, 0.0002, -0.0005, -0.005})));
}

TEST(FindFold, FindsPixelsBeyondTheMaximumAngle) {
  const std::array<double, 4> none = {};
  CameraModel camera = camera_with_distortion({LensModel::fisheye, none});
  EXPECT_FALSE(find_fold(camera));
  camera.fx = camera.fy = 200.0;  // the corners at 400 px: 2 rad
  const std::optional<LensFold> fold = find_fold(camera);
  ASSERT_TRUE(fold);
  EXPECT_FALSE(fold->is_fold);
}

TEST(CameraModel, UndistortedKeepsTheIntrinsics) {
  const CameraModel pinhole = camera_with_distortion({0.1, 0, 0, 0, 0}).undistorted();
  EXPECT_FALSE(pinhole.has_distortion());
  EXPECT_EQ(pinhole.fy, 520.0);
}

}  // namespace
}  // namespace pcavr
