// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// From clouds to images: the camera of an organised cloud, range images of others.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/recordings/cloud/pinhole_fit.hpp"
#include "pcavr/recordings/cloud/range_image.hpp"

namespace pcavr {
namespace {

CameraModel test_camera() {
  return {.width = 80, .height = 60, .fx = 71.5, .fy = 70.25, .cx = 38.5, .cy = 30.75};
}

/// Depth of a plane that is slanted by 60 degrees about the vertical, 1 m away [m].
double plane_depth(double x_over_z) { return 1.0 / (1.0 + std::tan(M_PI / 3.0) * 0.3 * x_over_z); }

/// The points of a slanted plane at the camera's pixels, in its axes; every 7th is missing.
std::vector<Eigen::Vector3f> organised_points(const CameraModel& camera) {
  std::vector<Eigen::Vector3f> points;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const double x = (u - camera.cx) / camera.fx;
      Eigen::Vector3f point =
          camera.unproject({double(u), double(v)}, plane_depth(x)).cast<float>();
      if ((u + v) % 7 == 0) point.setConstant(std::numeric_limits<float>::quiet_NaN());
      points.push_back(point);
    }
  }
  return points;
}

std::vector<Eigen::Vector3f> rotated(const Pose& pose, std::vector<Eigen::Vector3f> points) {
  for (Eigen::Vector3f& p : points) p = (pose * p.cast<double>()).cast<float>();
  return points;
}

TEST(PinholeFit, FindsTheCameraInEachConventionOfAxes) {
  const CameraModel camera = test_camera();
  for (const SensorAxes axes : {SensorAxes::optical, SensorAxes::robot, SensorAxes::graphics}) {
    const Pose T_sensor_camera = sensor_camera_pose(axes);
    const auto fit = fit_pinhole(camera.width, camera.height,
                                 rotated(T_sensor_camera, organised_points(camera)));
    ASSERT_TRUE(fit);
    EXPECT_NEAR(fit->camera.fx, camera.fx, 1e-3);
    EXPECT_NEAR(fit->camera.fy, camera.fy, 1e-3);
    EXPECT_NEAR(fit->camera.cx, camera.cx, 1e-3);
    EXPECT_NEAR(fit->camera.cy, camera.cy, 1e-3);
    EXPECT_LT(fit->residual_rms, 1e-3);
    EXPECT_FALSE(fit->is_mirrored);
    EXPECT_LT(rotation_distance(fit->T_sensor_camera, T_sensor_camera), 1e-9);
  }
}

TEST(PinholeFit, AnUpsideDownImageIsTurned) {
  const CameraModel camera = test_camera();
  const Pose half_turn(Eigen::Quaterniond(0, 0, 0, 1), Eigen::Vector3d::Zero());
  const auto fit =
      fit_pinhole(camera.width, camera.height, rotated(half_turn, organised_points(camera)));
  ASSERT_TRUE(fit);
  EXPECT_LT(fit->residual_rms, 1e-3);
  EXPECT_LT(rotation_distance(fit->T_sensor_camera, half_turn), 1e-7);
}

TEST(PinholeFit, MirroredCloudsAreRecognised) {
  const CameraModel camera = test_camera();
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<Eigen::Vector3f> points = organised_points(camera);
    for (Eigen::Vector3f& p : points) p[axis] = -p[axis];
    const auto fit = fit_pinhole(camera.width, camera.height, points);
    ASSERT_TRUE(fit) << axis;
    EXPECT_TRUE(fit->is_mirrored) << axis;
    EXPECT_LT(fit->residual_rms, 1e-3) << axis;
  }
}

/// Columns at equal angles, as of a turning scanner.
TEST(PinholeFit, AScannersGridHasALargeResidual) {
  std::vector<Eigen::Vector3f> points;
  for (int v = 0; v < 40; ++v) {
    for (int u = 0; u < 80; ++u) {
      const double yaw = (u - 40) * 0.02;
      const double pitch = (v - 20) * 0.01;
      points.emplace_back(static_cast<float>(2.0 * std::sin(yaw) * std::cos(pitch)),
                          static_cast<float>(2.0 * std::sin(pitch)),
                          static_cast<float>(2.0 * std::cos(yaw) * std::cos(pitch)));
    }
  }
  const auto fit = fit_pinhole(80, 40, points);
  ASSERT_TRUE(fit);
  EXPECT_GT(fit->residual_rms, kMaxPinholeResidual);
}

/// Rays at random through a view of the slanted plane, with the colour of their position.
struct RandomRays {
  std::vector<Eigen::Vector3f> points;
  std::vector<Rgb8> colors;
};

RandomRays random_rays(int count) {
  RandomRays rays;
  Random random(3);
  for (int i = 0; i < count; ++i) {
    const double x = random.uniform(-0.5, 0.5);
    const double y = random.uniform(-0.4, 0.4);
    const double z = plane_depth(x);
    rays.points.push_back(Eigen::Vector3d(x * z, y * z, z).cast<float>());
    const auto grey = static_cast<std::uint8_t>(std::lround(255.0 * (x + 0.5)));
    rays.colors.push_back({grey, grey, 200});
  }
  return rays;
}

TEST(RangeImage, CameraHasTheCloudsResolution) {
  // 100 rays per unit of the plane z = 1 in each direction.
  const RandomRays rays = random_rays(8000);
  const std::vector<std::vector<Eigen::Vector3f>> clouds = {rays.points};
  const RangeCameras cameras = choose_range_cameras(clouds);
  ASSERT_EQ(cameras.T_sensor_camera.size(), 1U);
  EXPECT_NEAR(cameras.camera.fx, 100.0, 10.0);
  EXPECT_NEAR(cameras.camera.width, 104, 12);
  EXPECT_NEAR(cameras.camera.height, 84, 10);
}

/// The cloud of a depth camera without its unmeasured points: its pixels are found again.
TEST(RangeImage, ADepthCamerasGridIsFoundInItsRays) {
  const CameraModel camera = test_camera();
  const std::vector<std::vector<Eigen::Vector3f>> clouds = {organised_points(camera)};
  const RangeCameras cameras = choose_range_cameras(clouds);
  EXPECT_EQ(cameras.camera.width, camera.width);
  EXPECT_EQ(cameras.camera.height, camera.height);
  EXPECT_NEAR(cameras.camera.fx, camera.fx, 1e-3);
  EXPECT_NEAR(cameras.camera.fy, camera.fy, 1e-3);
  EXPECT_NEAR(cameras.camera.cx, camera.cx, 1e-3);
  EXPECT_NEAR(cameras.camera.cy, camera.cy, 1e-3);
  const RangeImage image = render_range_image(clouds.front(), {}, cameras.camera, Pose());
  for (int u = 1; u + 1 < camera.width; ++u) {
    EXPECT_NEAR(image.depth(u, 30), plane_depth((u - camera.cx) / camera.fx), 1e-5);
  }
}

/// A pixel's ray is up to 0.7 pixels from its centre, where this plane's depth differs by up to
/// 5 mm; without correction the rms is 2 mm.
TEST(RangeImage, SlantedSurfacesAreNotBiased) {
  const RandomRays rays = random_rays(8000);
  const CameraModel camera{
      .width = 100, .height = 80, .fx = 100.0, .fy = 100.0, .cx = 49.5, .cy = 39.5};
  const RangeImage image = render_range_image(rays.points, rays.colors, camera, Pose());
  double sum = 0.0;
  int count = 0;
  int holes = 0;
  double color_sum = 0.0;
  for (int v = 2; v < camera.height - 2; ++v) {
    for (int u = 2; u < camera.width - 2; ++u) {
      const double z = static_cast<double>(image.depth(u, v));
      holes += z == 0.0 ? 1 : 0;
      if (z == 0.0) continue;
      const double x = (u - camera.cx) / camera.fx;
      sum += std::pow(z - plane_depth(x), 2);
      color_sum += std::pow(static_cast<double>(image.color(u, v).r) - 255.0 * (x + 0.5), 2);
      ++count;
    }
  }
  EXPECT_LT(std::sqrt(sum / count), 2e-4);
  EXPECT_LT(std::sqrt(color_sum / count), 2.0);
  // A pixel has no ray with probability 1 / e, and stays empty unless both left and right, or both
  // above and below, have one: (1 - (1 - 1 / e)^2)^2 / e.
  EXPECT_NEAR(static_cast<double>(holes) / (holes + count), 0.1327, 0.012);
  EXPECT_EQ(image.points_used, 8000U);
}

TEST(RangeImage, TheNearerSurfaceHidesTheFarther) {
  std::vector<Eigen::Vector3f> points;
  for (int v = 0; v < 20; ++v) {
    for (int u = 0; u < 20; ++u) {
      for (const float z : {2.0F, 1.0F}) {
        points.emplace_back(static_cast<float>(u - 10) * 0.1F * z,
                            static_cast<float>(v - 10) * 0.1F * z, z);
      }
    }
  }
  const CameraModel camera{.width = 20, .height = 20, .fx = 10, .fy = 10, .cx = 10, .cy = 10};
  const RangeImage image = render_range_image(points, {}, camera, Pose());
  for (const float z : image.depth.pixels()) EXPECT_EQ(z, 1.0F);
  EXPECT_EQ(image.points_used, 400U);
}

TEST(RangeImage, PointsAroundTheSensorNeedSixFaces) {
  Random random(5);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 40'000; ++i) {
    points.push_back(
        (2.0 * Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized())
            .cast<float>());
  }
  const std::vector<std::vector<Eigen::Vector3f>> clouds = {points};
  const RangeCameras cameras = choose_range_cameras(clouds);
  ASSERT_EQ(cameras.T_sensor_camera.size(), 6U);
  std::size_t used = 0;
  for (const Pose& face : cameras.T_sensor_camera) {
    const RangeImage image = render_range_image(points, {}, cameras.camera, face);
    used += image.points_used;
    // The middle of each face looks straight at the sphere; some of its pixels have no ray.
    float z = 0.0F;
    for (int i = -2; i <= 2; ++i) {
      z = std::max(z, image.depth(cameras.camera.width / 2 + i, cameras.camera.height / 2));
    }
    EXPECT_NEAR(z, 2.0F, 2e-3F);
  }
  // The margins of the faces overlap.
  EXPECT_GE(used, points.size());
  EXPECT_LT(used, points.size() * 12 / 10);
}

}  // namespace
}  // namespace pcavr
