// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/pictures/augmented_drawing.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "scene/scene_builder.hpp"

namespace pcavr {
namespace {

constexpr Rgb8 kGray{90, 90, 90};

CameraModel a_camera(bool is_distorted) {
  CameraModel camera{.width = 320, .height = 240, .fx = 260, .fy = 262, .cx = 158, .cy = 121};
  if (is_distorted) camera.distortion = {-0.25, 0.08, 0.001, -0.002, 0.0};
  return camera;
}

Pose a_view(const Eigen::Vector3d& p_camera, double turn) {
  const Eigen::Quaterniond q(Eigen::AngleAxisd(turn, Eigen::Vector3d(1, 2, 0.5).normalized()));
  return Pose(q, p_camera);
}

ColorImage drawn(const CameraModel& camera, const std::vector<BodyInView>& solid,
                 const std::vector<BodyInView>& ghosts = {}, float wall = 0.0F, int threads = 1) {
  ColorImage picture(camera.width, camera.height, kGray);
  const DepthImage depth(camera.width, camera.height, wall);
  draw_bodies(picture, depth, camera, solid, ghosts, {threads});
  return picture;
}

std::size_t changed(const ColorImage& picture) {
  return static_cast<std::size_t>(std::count_if(picture.pixels().begin(), picture.pixels().end(),
                                                [](const Rgb8& p) { return !(p == kGray); }));
}

/// Difference of a pixel from the gray background.
int strength(const ColorImage& picture, int x, int y) {
  const Rgb8& p = picture(x, y);
  return std::abs(p.r - kGray.r) + std::abs(p.g - kGray.g) + std::abs(p.b - kGray.b);
}

class AugmentedDrawing : public testing::Test {
 protected:
  const SurfaceQuery box_{a_box({0.1F, 0.2F, 0.08F})};
  const Pose T_camera_box_ = a_view({0.12, -0.08, 0.7}, 0.6);
};

TEST_F(AugmentedDrawing, DrawsTheSilhouetteWithinAPixelThroughAnyLens) {
  for (const bool is_distorted : {false, true}) {
    const CameraModel camera = a_camera(is_distorted);
    const ColorImage picture = drawn(camera, {{&box_, T_camera_box_}});
    // A pixel is drawn where its ray hits the box; only those at the silhouette may differ.
    const DepthImage ideal = render_depth(box_, camera, T_camera_box_.inverse());
    int inside = 0;
    for (int y = 2; y < camera.height - 2; ++y) {
      for (int x = 2; x < camera.width - 2; ++x) {
        int hits = 0;
        for (int dy = -2; dy <= 2; ++dy) {
          for (int dx = -2; dx <= 2; ++dx) hits += ideal(x + dx, y + dy) > 0.0F ? 1 : 0;
        }
        if (hits == 25) {
          EXPECT_GT(strength(picture, x, y), 0) << x << ' ' << y;
        }
        if (hits == 0) {
          EXPECT_EQ(strength(picture, x, y), 0) << x << ' ' << y;
        }
        inside += hits == 25 ? 1 : 0;
      }
    }
    EXPECT_GT(inside, 500);
  }
}

TEST_F(AugmentedDrawing, DrawsAnEdgeWhereTwoFacesMeetAndNoneInAFace) {
  const CameraModel camera = a_camera(true);
  const ColorImage picture = drawn(camera, {{&box_, T_camera_box_}});
  // Edges between those of the eight corners that the camera sees.
  int edges = 0;
  for (int from = 0; from < 8; ++from) {
    for (const int bit : {1, 2, 4}) {
      const int to = from | bit;
      if (to == from) continue;
      const auto corner = [&](int i) {
        return Eigen::Vector3d(i & 1 ? 0.05 : -0.05, i & 2 ? 0.1 : -0.1, i & 4 ? 0.04 : -0.04);
      };
      const Eigen::Vector3d middle =
          T_camera_box_ * Eigen::Vector3d(0.5 * (corner(from) + corner(to)));
      const Eigen::Vector3f p_object_camera =
          (T_camera_box_.inverse() * Eigen::Vector3d::Zero()).cast<float>();
      const Eigen::Vector3d middle_object = 0.5 * (corner(from) + corner(to));
      const auto hit =
          box_.cast(p_object_camera, middle_object.cast<float>() * 0.999F - p_object_camera);
      const bool is_seen =
          hit && hit->distance > (middle_object.cast<float>() - p_object_camera).norm() - 1e-3F;
      if (!is_seen) continue;
      const Eigen::Vector2d pixel = camera.project(middle);
      const int x = static_cast<int>(std::lround(pixel.x()));
      const int y = static_cast<int>(std::lround(pixel.y()));
      EXPECT_GT(strength(picture, x, y), 120) << from << ' ' << to;
      ++edges;
    }
  }
  EXPECT_GE(edges, 5);
  // The centre of the nearest face: filled, without an edge line.
  const Eigen::Vector2d face = camera.project(T_camera_box_ * Eigen::Vector3d(0, 0, -0.04));
  EXPECT_LT(strength(picture, static_cast<int>(face.x()), static_cast<int>(face.y())), 120);
}

TEST_F(AugmentedDrawing, OccludesABodyBehindANearerOne) {
  const CameraModel camera = a_camera(false);
  const BodyInView front{&box_, a_view({0.0, 0.0, 0.5}, 0.0)};
  const SurfaceQuery small(a_box({0.02F, 0.02F, 0.02F}));
  const BodyInView behind{&small, a_view({0.0, 0.0, 0.9}, 0.4)};
  const ColorImage one = drawn(camera, {front});
  for (const auto& bodies : {std::vector{behind, front}, std::vector{front, behind}}) {
    const ColorImage both = drawn(camera, bodies);
    EXPECT_TRUE(std::equal(both.pixels().begin(), both.pixels().end(), one.pixels().begin()));
  }
}

TEST_F(AugmentedDrawing, IsFainterWhereTheRecordedDepthOccludesIt) {
  const CameraModel camera = a_camera(false);
  const BodyInView body{&box_, a_view({0.0, 0.0, 0.8}, 0.0)};
  const ColorImage seen = drawn(camera, {body}, {}, 0.8F);
  const ColorImage hidden = drawn(camera, {body}, {}, 0.4F);
  const int x = static_cast<int>(camera.cx);
  const int y = static_cast<int>(camera.cy);
  EXPECT_GT(strength(hidden, x, y), 0);
  EXPECT_LT(strength(hidden, x, y), strength(seen, x, y) / 2);
}

TEST_F(AugmentedDrawing, DrawsGhostsAsLinesOnly) {
  const CameraModel camera = a_camera(false);
  const BodyInView body{&box_, a_view({0.0, 0.0, 0.5}, 0.0)};
  const ColorImage ghost = drawn(camera, {}, {body});
  EXPECT_EQ(strength(ghost, static_cast<int>(camera.cx), static_cast<int>(camera.cy)), 0);
  EXPECT_GT(changed(ghost), 100U);
  EXPECT_LT(changed(ghost), changed(drawn(camera, {body})) / 4);
}

TEST_F(AugmentedDrawing, DrawsNothingBehindTheCameraOrOutsideTheImage) {
  const CameraModel camera = a_camera(true);
  EXPECT_EQ(changed(drawn(camera, {{&box_, a_view({0.0, 0.0, -0.8}, 0.3)}})), 0U);
  EXPECT_EQ(changed(drawn(camera, {{&box_, a_view({9.0, 0.0, 0.8}, 0.3)}})), 0U);
  EXPECT_EQ(changed(drawn(camera, {})), 0U);
}

TEST_F(AugmentedDrawing, DrawsNoEdgeAtTheImageBorder) {
  const CameraModel camera = a_camera(false);
  // The box is so near that its face fills the image: no edge.
  const ColorImage picture = drawn(camera, {{&box_, a_view({0.0, 0.0, 0.07}, 0.0)}});
  for (int y = 0; y < camera.height; ++y) EXPECT_EQ(picture(0, y), picture(160, 120)) << y;
}

TEST_F(AugmentedDrawing, HasTheSameBytesForAnyNumberOfThreads) {
  const CameraModel camera = a_camera(true);
  const std::vector<BodyInView> solid{{&box_, T_camera_box_}};
  const std::vector<BodyInView> ghosts{{&box_, a_view({0.1, -0.08, 0.7}, 0.5)}};
  const ColorImage once = drawn(camera, solid, ghosts, 0.7F, 1);
  for (const int threads : {2, 4}) {
    const ColorImage again = drawn(camera, solid, ghosts, 0.7F, threads);
    EXPECT_TRUE(std::equal(once.pixels().begin(), once.pixels().end(), again.pixels().begin()));
  }
}

}  // namespace
}  // namespace pcavr
