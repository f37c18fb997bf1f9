// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <gtest/gtest.h>

#include "pcavr/base/model/cad_model.hpp"

#include "support/meshes.hpp"

namespace pcavr {
namespace {

using test::box_mesh;
using test::sphere_mesh;

CameraModel small_camera() {
  CameraModel camera;
  camera.width = 160;
  camera.height = 120;
  camera.fx = camera.fy = 130.0;
  camera.cx = 79.5;
  camera.cy = 59.5;
  return camera;
}

/// Looking along -z of the mesh, from `height` above its origin.
Pose from_above(double height) {
  return Pose(Eigen::Quaterniond(0, 1, 0, 0), Eigen::Vector3d(0, 0, height));
}

/// One ray for every pixel, without the bounding rectangle.
DepthImage render_brute_force(const SurfaceQuery& surface, const CameraModel& camera,
                              const Pose& T_mesh_camera) {
  DepthImage depth(camera.width, camera.height, 0.0F);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector3d ray = camera.unproject({x, y}, 1.0);
      const auto hit = surface.cast(T_mesh_camera.translation().cast<float>(),
                                    (T_mesh_camera.rotation() * ray).cast<float>());
      if (hit) depth(x, y) = hit->distance / static_cast<float>(ray.norm());
    }
  }
  return depth;
}

std::vector<float> values(const DepthImage& image) {
  return {image.pixels().begin(), image.pixels().end()};
}

// Depth is along the optical axis: constant on a plane that faces the camera.
TEST(RenderDepth, IsConstantOnAFaceSeenHeadOn) {
  const SurfaceQuery surface(box_mesh({0.4F, 0.3F, 0.2F}));
  const CameraModel camera = small_camera();
  const DepthImage depth = render_depth(surface, camera, from_above(0.6));
  int seen = 0;
  for (const float z : depth.pixels()) {
    if (z == 0.0F) continue;
    ++seen;
    EXPECT_NEAR(z, 0.5F, 1e-6F);
  }
  // The top face covers (0.4 f / 0.5) by (0.3 f / 0.5) pixels: 104 by 78.
  EXPECT_EQ(seen, 104 * 78);
}

TEST(RenderDepth, RendersASphereAtItsDepth) {
  const SurfaceQuery surface(sphere_mesh(0.1F, 90));
  const CameraModel camera = small_camera();
  const DepthImage depth = render_depth(surface, camera, from_above(0.5));
  EXPECT_NEAR(depth(80, 60), 0.4F, 2e-4F);  // the sag of 90 rings is 0.06 mm, half a pixel 0.02
  EXPECT_EQ(depth(5, 5), 0.0F);
}

TEST(RenderDepth, EqualsOneRayForEveryPixel) {
  Random random(7);
  const SurfaceQuery surface(test::triangle_soup(200, random));
  CameraModel camera = small_camera();
  const std::array<double, 4> fisheye = {-0.0117, 0.0301, -0.0274, 0.0079};
  for (int trial = 0; trial < 18; ++trial) {
    if (trial >= 6) camera.distortion = {-0.25, 0.08, 0.001, -0.002, 0.0};
    if (trial >= 12) camera.distortion = LensDistortion(LensModel::fisheye, fisheye);
    Vector6d twist;
    for (int k = 0; k < 6; ++k) twist[k] = random.uniform(-1.5, 1.5);
    const Pose T_mesh_camera = Pose::exp(twist);
    EXPECT_EQ(values(render_depth(surface, camera, T_mesh_camera)),
              values(render_brute_force(surface, camera, T_mesh_camera)));
  }
}

TEST(RenderDepth, IsEmptyForABodyBehindTheCamera) {
  const SurfaceQuery surface(box_mesh({0.1F, 0.1F, 0.1F}));
  const Pose T_mesh_camera = Pose::from_translation({0, 0, 1});  // looks away, along +z
  const DepthImage depth = render_depth(surface, small_camera(), T_mesh_camera);
  EXPECT_TRUE(std::ranges::all_of(depth.pixels(), [](float z) { return z == 0.0F; }));
  EXPECT_TRUE(visible_rectangle(surface.bounds(), small_camera(), T_mesh_camera).empty());
}

TEST(RenderDepth, IsBitwiseIdenticalForAnyNumberOfThreads) {
  const SurfaceQuery surface(sphere_mesh(0.2F, 40));
  const std::vector<float> expected =
      values(render_depth(surface, small_camera(), from_above(0.5)));
  for (const int threads : {2, 4}) {
    EXPECT_EQ(values(render_depth(surface, small_camera(), from_above(0.5), {threads})), expected);
  }
}

TEST(VisibleRectangle, TightlyContainsTheBody) {
  const SurfaceQuery surface(box_mesh({0.1F, 0.1F, 0.1F}));
  const PixelRectangle rectangle =
      visible_rectangle(surface.bounds(), small_camera(), from_above(0.6));
  // The face at 0.55 m is 23.6 pixels wide about (79.5, 59.5).
  EXPECT_GE(rectangle.x_begin, 64);
  EXPECT_LE(rectangle.x_begin, 68);
  EXPECT_GE(rectangle.x_end, 92);
  EXPECT_LE(rectangle.x_end, 96);
}

}  // namespace
}  // namespace pcavr
