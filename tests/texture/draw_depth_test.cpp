// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/texture/draw_depth.hpp"

#include <gtest/gtest.h>

#include "pcavr/base/model/cad_model.hpp"

namespace pcavr {
namespace {

/// A wavy surface above z = 0 in squares of 1 cm, 1.2 m wide: it hides parts of itself.
TriangleMesh wavy_surface() {
  constexpr std::uint32_t kSide = 121;
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < kSide; ++i) {
    for (std::uint32_t j = 0; j < kSide; ++j) {
      const float x = 0.01F * static_cast<float>(i) - 0.6F;
      const float y = 0.01F * static_cast<float>(j) - 0.6F;
      mesh.vertices.emplace_back(x, y, 0.05F * std::sin(30.0F * x) * std::cos(20.0F * y));
      if (i + 1 == kSide || j + 1 == kSide) continue;
      const std::uint32_t v = i * kSide + j;
      mesh.triangles.push_back({v, v + kSide, v + 1});
      mesh.triangles.push_back({v + 1, v + kSide, v + kSide + 1});
    }
  }
  return mesh;
}

CameraModel camera_with(double k1) {
  CameraModel camera{
      .width = 160, .height = 120, .fx = 130.0, .fy = 131.0, .cx = 81.5, .cy = 58.25};
  camera.distortion = {k1, 0.0, 0.0, 0.0, 0.0};
  return camera;
}

/// Seen obliquely, from 0.7 m; the surface ends within the image.
Pose oblique_view() {
  const Eigen::Quaterniond tilt(Eigen::AngleAxisd(2.4, Eigen::Vector3d::UnitX()));
  return Pose(tilt, Eigen::Vector3d(0.02, 0.45, 0.5));
}

/// Share of the pixels in which rasterisation and ray casting agree within 1 mm.
double share_in_agreement(const CameraModel& camera) {
  const TriangleMesh mesh = wavy_surface();
  const DepthImage drawn = draw_depth(mesh, camera, oblique_view().inverse());
  const DepthImage cast = render_depth(SurfaceQuery(mesh), camera, oblique_view());
  int seen = 0;
  int agreeing = 0;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      seen += cast(x, y) > 0.0F ? 1 : 0;
      agreeing += std::abs(drawn(x, y) - cast(x, y)) < 1e-3F ? 1 : 0;
    }
  }
  EXPECT_GT(seen, camera.width * camera.height / 3);
  EXPECT_LT(seen, camera.width * camera.height);
  return static_cast<double>(agreeing) / (camera.width * camera.height);
}

TEST(DrawDepth, AgreesWithRayCasting) { EXPECT_GT(share_in_agreement(camera_with(0.0)), 0.998); }

TEST(DrawDepth, AgreesWithRayCastingThroughADistortingLens) {
  EXPECT_GT(share_in_agreement(camera_with(-0.2)), 0.99);
}

TEST(DrawDepth, LeavesOutWhatIsBehindTheCamera) {
  TriangleMesh mesh;
  mesh.vertices = {{-1.0F, -1.0F, -1.0F}, {1.0F, -1.0F, -1.0F}, {0.0F, 1.0F, -1.0F}};
  mesh.triangles = {{0, 1, 2}};
  const DepthImage depth = draw_depth(mesh, camera_with(0.0), Pose());
  for (const float value : depth.pixels()) EXPECT_EQ(value, 0.0F);
}

}  // namespace
}  // namespace pcavr
