// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/texture/mesh_texture.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "pcavr/perception/marker/tag_detector.hpp"
#include "pcavr/perception/marker/tag_sheet.hpp"

#include "texture/painted_wall.hpp"

namespace pcavr {
namespace {

using test::take_view;
using test::take_views;
using test::texture_at;
using test::wall_camera;
using test::wall_levels;
using test::wall_view;
using test::wall_views;

MeshTexture paint(std::vector<TriangleMesh>& levels, const std::vector<TextureView>& views,
                  const TextureOptions& options = {}, int threads = 2) {
  return paint_texture(levels, views, wall_camera(), DepthNoise(), options, {threads});
}

/// Options without the offset of colour from depth, whose search takes the time.
TextureOptions without_registration() {
  TextureOptions options;
  options.register_color = false;
  return options;
}

/// Blobs of different sizes: there is something to align everywhere.
Eigen::Vector3d blobs(double x, double y) {
  const double a = std::sin(90.0 * x) * std::sin(80.0 * y);
  const double b = std::sin(37.0 * x + 1.0) * std::cos(41.0 * y);
  return {128.0 + 60.0 * a + 30.0 * b, 120.0 + 50.0 * b, 110.0 + 60.0 * a};
}

TEST(MeshTexture, HasTheColoursOfTheImagesInEveryLevel) {
  std::vector<TriangleMesh> levels = wall_levels();
  const MeshTexture texture = paint(levels, take_views(blobs));
  ASSERT_FALSE(texture.empty());
  EXPECT_GT(texture.seen_fraction, 0.95);
  for (std::size_t level = 0; level < levels.size(); ++level) {
    double worst = 0.0;
    for (double x = -0.2; x < 0.2; x += 0.017) {
      for (double y = -0.13; y < 0.13; y += 0.013) {
        const Eigen::Vector3d difference =
            texture_at(texture, levels[level], level, x, y) - blobs(x, y);
        worst = std::max(worst, difference.cwiseAbs().maxCoeff());
      }
    }
    // The pattern changes by 6 over the 3 mm of a pixel's smoothing.
    EXPECT_LT(worst, 10.0) << "level " << level;
  }
}

TEST(MeshTexture, ATagIsDecodedInALevelOfTwoTriangles) {
  const Expected<TagPicture> tag = tag_picture("tag36h11", 42);
  ASSERT_TRUE(tag) << tag.error().to_string();
  constexpr double kEdge = 0.16;  // of the whole picture [m]
  const auto color = [&](double x, double y) -> Eigen::Vector3d {
    const double cell = kEdge / tag->cells;
    const int column = static_cast<int>(std::floor((x + 0.5 * kEdge) / cell));
    const int row = static_cast<int>(std::floor((0.5 * kEdge - y) / cell));
    const bool is_on_tag = column >= 0 && row >= 0 && column < tag->cells && row < tag->cells;
    const bool is_white =
        !is_on_tag || tag->is_white[static_cast<std::size_t>(row * tag->cells + column)];
    return Eigen::Vector3d::Constant(is_white ? 220.0 : 25.0);
  };
  std::vector<TriangleMesh> levels = wall_levels();
  const MeshTexture texture = paint(levels, take_views(color));
  ASSERT_FALSE(texture.empty());
  const auto from_texture = [&](double x, double y) {
    return texture_at(texture, levels.back(), levels.size() - 1, x, y);
  };
  const TextureView seen = take_view(wall_view({0.1, 0.1, 0.5}), from_texture);
  Expected<TagDetector> detector = TagDetector::create({"tag36h11"});
  ASSERT_TRUE(detector) << detector.error().to_string();
  const std::vector<TagDetection> found = detector->detect(to_gray(seen.color));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found.front().id.id, 42);
  EXPECT_EQ(found.front().hamming, 0);
}

TEST(MeshTexture, AShadowInAMinorityOfTheViewsDoesNotStay) {
  const auto gray = [](double, double) { return Eigen::Vector3d::Constant(150.0).eval(); };
  const auto shadowed = [](double x, double y) {
    return Eigen::Vector3d::Constant(std::hypot(x, y) < 0.05 ? 80.0 : 150.0).eval();
  };
  std::vector<TextureView> views = take_views(gray);
  views[0] = take_view(wall_views()[0], shadowed);  // the nearest ones
  views[4] = take_view(wall_views()[4], shadowed);
  std::vector<TriangleMesh> levels = wall_levels();
  const MeshTexture texture = paint(levels, views);
  EXPECT_NEAR(texture_at(texture, levels[0], 0, 0.0, 0.0).x(), 150.0, 4.0);
}

/// A view of the gray wall with a green post before it, which is wider in the colours than in the
/// depth, and beside which the sensor measured nothing.
TextureView view_of_post() {
  TextureView view = take_view(wall_view({0.0, 0.0, 0.6}), [](double, double) {
    return Eigen::Vector3d::Constant(150.0).eval();
  });
  for (int y = 0; y < view.depth.height(); ++y) {
    for (int x = 149; x < 171; ++x) {
      view.depth(x, y) = x >= 150 && x < 170 ? 0.4F : 0.0F;
      view.color(x, y) = {20, 200, 20};
    }
  }
  return view;
}

TEST(MeshTexture, HasNoColourOfANearerSurfaceBesideIt) {
  std::vector<TriangleMesh> levels = wall_levels();
  const MeshTexture texture = paint(levels, {view_of_post()}, without_registration());
  ASSERT_FALSE(texture.empty());
  for (double pixel = 136.0; pixel < 149.5; pixel += 0.5) {
    const double x = 0.6 * (pixel - 159.5) / 300.0;
    const Eigen::Vector3d color = texture_at(texture, levels[0], 0, x, 0.0);
    EXPECT_LT(color.y() - color.x(), 12.0) << "pixel " << pixel;
  }
}

// The mesh may reach up to the edge, and what was fused there has the post's colour.
TEST(MeshTexture, HasNoFusedColourOfANearerSurfaceJustBehindItsEdge) {
  TextureView view = view_of_post();
  for (int y = 0; y < view.depth.height(); ++y) view.depth(149, y) = view.depth(148, y);
  std::vector<TriangleMesh> levels = wall_levels();
  for (TriangleMesh& level : levels) {
    for (Rgb8& color : level.colors) color = {20, 200, 20};
  }
  const MeshTexture texture = paint(levels, {view}, without_registration());
  const auto greenness_at = [&](double pixel) {
    const double x = 0.6 * (pixel - 159.5) / 300.0;
    const Eigen::Vector3d color = texture_at(texture, levels[0], 0, x, 0.0);
    return color.y() - color.x();
  };
  for (double pixel = 149.0; pixel < 151.0; pixel += 0.25)
    EXPECT_LT(greenness_at(pixel), 12.0) << "pixel " << pixel;
  EXPECT_GT(greenness_at(159.5), 170.0);  // nothing is known there but what was fused
}

/// Ratio of the highest to the lowest brightness relative to blobs in a texture from views with
/// these gains and offsets.
double unevenness(double gain_step, double offset_step) {
  std::vector<TextureView> views;
  for (std::size_t i = 0; i < wall_views().size(); ++i) {
    const double at = static_cast<double>(i) - 3.0;
    views.push_back(take_view(wall_views()[i], [=](double x, double y) -> Eigen::Vector3d {
      return (1.0 + gain_step * at) * blobs(x, y) + Eigen::Vector3d::Constant(offset_step * at);
    }));
  }
  std::vector<TriangleMesh> levels = wall_levels();
  const MeshTexture texture = paint(levels, views);
  double lowest = 10.0;
  double highest = 0.0;
  for (double x = -0.2; x < 0.2; x += 0.02) {
    for (double y = -0.12; y < 0.12; y += 0.02) {
      const double ratio = texture_at(texture, levels[0], 0, x, y).y() / blobs(x, y).y();
      lowest = std::min(lowest, ratio);
      highest = std::max(highest, ratio);
    }
  }
  return highest / lowest;
}

TEST(MeshTexture, ExposuresAreEvenedOut) {
  // The images differ by a factor of 1.35.
  EXPECT_LT(unevenness(0.05, 0.0), 1.12);
}

TEST(MeshTexture, StrayLightIsEvenedOut) {
  // The images differ by 30 of 255 everywhere.
  EXPECT_LT(unevenness(0.0, 5.0), 1.06);
}

/// The view as a camera takes it that loses this share of the light times the squared slope.
TextureView vignetted(TextureView view, double vignetting) {
  const CameraModel camera = wall_camera();
  for (int y = 0; y < view.color.height(); ++y) {
    for (int x = 0; x < view.color.width(); ++x) {
      const Eigen::Vector2d slope((x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy);
      const double share = 1.0 - vignetting * slope.squaredNorm();
      Rgb8& c = view.color(x, y);
      for (std::uint8_t* channel : {&c.r, &c.g, &c.b})
        *channel = static_cast<std::uint8_t>(std::lround(share * *channel));
    }
  }
  return view;
}

TEST(MeshTexture, TheVignettingOfTheCameraIsFound) {
  // The corners lose 22 % of the light.
  constexpr double kVignetting = 0.5;
  std::vector<TextureView> views = take_views(blobs);
  for (TextureView& view : views) view = vignetted(std::move(view), kVignetting);
  std::vector<TriangleMesh> levels = wall_levels();
  EXPECT_NEAR(paint(levels, views, without_registration()).registration.vignetting, kVignetting,
              0.05);
}

TEST(MeshTexture, WithoutMotionNoVignettingIsFound) {
  const TextureView view = vignetted(take_view(wall_views()[1], blobs), 0.5);
  std::vector<TriangleMesh> levels = wall_levels();
  EXPECT_NEAR(paint(levels, {7, view}, without_registration()).registration.vignetting, 0.0, 1e-3);
}

TEST(MeshTexture, FineDetailKeepsItsContrast) {
  // Six pixels of the nearest view a period.
  const auto wave = [](double x, double y) { return std::sin(600.0 * x) * std::sin(600.0 * y); };
  std::vector<TriangleMesh> levels = wall_levels();
  const std::vector<TextureView> views = take_views([&](double x, double y) -> Eigen::Vector3d {
    return Eigen::Vector3d::Constant(128.0 + 80.0 * wave(x, y));
  });
  const MeshTexture texture = paint(levels, views, without_registration());
  ASSERT_FALSE(texture.empty());
  double products = 0.0;
  double squares = 0.0;
  for (double x = -0.1; x < 0.1; x += 0.0017) {
    for (double y = -0.1; y < 0.1; y += 0.0013) {
      products += wave(x, y) * (texture_at(texture, levels.back(), 2, x, y).x() - 128.0);
      squares += 80.0 * wave(x, y) * wave(x, y);
    }
  }
  // Bilinear interpolation leaves 0.55; the pixels' and the texels' own areas take the rest.
  EXPECT_GT(products / squares, 0.63);
}

TEST(MeshTexture, WhatOnlyDynamicPixelsShowKeepsTheVerticesColour) {
  std::vector<TextureView> views = take_views(blobs);
  for (TextureView& view : views) {
    view.is_dynamic = MaskImage(view.depth.width(), view.depth.height(), 1);
  }
  std::vector<TriangleMesh> levels = wall_levels();
  const MeshTexture texture = paint(levels, views);
  EXPECT_EQ(texture.seen_fraction, 0.0);
  EXPECT_NEAR((texture_at(texture, levels[0], 0, 0.1, 0.1) - Eigen::Vector3d(90, 90, 90)).norm(),
              0.0, 1e-9);
}

TEST(MeshTexture, AnOffsetOfColourFromDepthIsFound) {
  CameraModel color_camera = wall_camera();
  color_camera.fx *= 0.95;
  color_camera.fy *= 0.95;
  const Pose T_color_depth = Pose::from_translation({0.025, 0.0, 0.0});
  std::vector<TextureView> views;
  for (const Pose& pose : wall_views()) {
    views.push_back(take_view(pose, blobs, color_camera, T_color_depth));
  }
  std::vector<TriangleMesh> levels = wall_levels();
  const MeshTexture texture = paint(levels, views);
  ASSERT_TRUE(texture.registration.is_estimated);
  // The pixel of a point at the wall's distance counts.
  const Eigen::Vector3d p(0.1, -0.05, 0.6);
  const Eigen::Vector2d truth = color_camera.project(T_color_depth * p);
  const Eigen::Vector2d found =
      texture.registration.camera.project(texture.registration.T_color_depth * p);
  const Eigen::Vector2d before = wall_camera().project(p);
  EXPECT_LT((found - truth).norm(), 0.15 * (before - truth).norm());
}

TEST(MeshTexture, AColourCameraOfAnotherFocalLengthIsFound) {
  // The cameras are like a Kinect's: 525 px beside 585 px, and axes that are not parallel.
  CameraModel color_camera = wall_camera();
  color_camera.fx *= 0.9;
  color_camera.fy *= 0.9;
  color_camera.cx += 4.0;
  color_camera.cy -= 6.0;
  const Pose T_color_depth = Pose::from_translation({-0.025, 0.0, 0.0});
  std::vector<TextureView> views;
  for (const Pose& pose : wall_views()) {
    views.push_back(take_view(pose, blobs, color_camera, T_color_depth));
  }
  std::vector<TriangleMesh> levels = wall_levels();
  const ColorRegistration found = paint(levels, views).registration;
  ASSERT_TRUE(found.is_estimated);
  for (const double x : {-0.15, 0.15}) {
    for (const double y : {-0.1, 0.1}) {
      const Eigen::Vector3d p(x, y, 0.6);
      const Eigen::Vector2d truth = color_camera.project(T_color_depth * p);
      EXPECT_LT((found.camera.project(found.T_color_depth * p) - truth).norm(), 1.0);
    }
  }
}

TEST(MeshTexture, IsTheSameForAnyNumberOfThreads) {
  std::vector<TriangleMesh> levels = wall_levels();
  std::vector<TriangleMesh> same_levels = wall_levels();
  const std::vector<TextureView> views = take_views(blobs);
  const MeshTexture one = paint(levels, views, {}, 1);
  const MeshTexture four = paint(same_levels, views, {}, 4);
  EXPECT_TRUE(std::ranges::equal(one.image.pixels(), four.image.pixels()));
  EXPECT_EQ(one.coordinates, four.coordinates);
}

TEST(MeshTexture, IsEmptyWithoutViews) {
  std::vector<TriangleMesh> levels = wall_levels();
  EXPECT_TRUE(paint(levels, {}).empty());
  EXPECT_EQ(levels[0].vertices.size(), wall_levels()[0].vertices.size());
}

// A camera that stands still, before which the wall moves, masked as all that moves.
TEST(BodyTexture, IsPaintedFromTheViewsOfABodyThatMoves) {
  std::vector<TextureView> views = take_views(blobs);
  std::vector<BodyView> seen_in;
  for (std::size_t i = 0; i < views.size(); ++i) {
    seen_in.push_back({i, views[i].T_base_camera});
    views[i].T_base_camera = Pose();
    views[i].is_dynamic = MaskImage(views[i].depth.width(), views[i].depth.height(), 1);
  }
  TriangleMesh body = test::wall_mesh(30, 20);
  MeshTexture scene;
  scene.registration.camera = wall_camera();
  const MeshTexture texture = paint_body(body, views, seen_in, scene, 512, DepthNoise(), {}, {2});
  ASSERT_FALSE(texture.empty());
  EXPECT_LE(texture.image.width(), 512);
  EXPECT_LE(texture.image.height(), 512);
  EXPECT_GT(texture.seen_fraction, 0.95);
  EXPECT_EQ(texture.coordinates.front().size(), body.vertices.size());
  for (double x = -0.2; x < 0.2; x += 0.017) {
    for (double y = -0.13; y < 0.13; y += 0.013) {
      const Eigen::Vector3d difference = texture_at(texture, body, 0, x, y) - blobs(x, y);
      EXPECT_LT(difference.cwiseAbs().maxCoeff(), 10.0) << x << ", " << y;
    }
  }
}

TEST(BodyTexture, HasTheExposuresThatWereFoundForTheScene) {
  const auto gray = [](double, double) { return Eigen::Vector3d::Constant(100.0).eval(); };
  const std::vector<TextureView> views = {take_view(wall_views()[0], gray)};
  TriangleMesh body = test::wall_mesh(1, 1);
  MeshTexture scene;
  scene.registration.camera = wall_camera();
  scene.exposures = {{Eigen::Vector3f::Constant(1.5F), Eigen::Vector3f::Constant(10.0F)}};
  const MeshTexture texture =
      paint_body(body, views, {{0, views[0].T_base_camera}}, scene, 256, DepthNoise(), {}, {1});
  EXPECT_NEAR(texture_at(texture, body, 0, 0.0, 0.0).x(), 160.0, 2.0);
}

TEST(BodyTexture, IsEmptyWhereNoViewShowsTheBody) {
  TriangleMesh body = test::wall_mesh(1, 1);
  MeshTexture scene;
  scene.registration.camera = wall_camera();
  EXPECT_TRUE(paint_body(body, take_views(blobs), {}, scene, 256, DepthNoise(), {}, {1}).empty());
  EXPECT_EQ(body.vertices.size(), 4U);
}

}  // namespace
}  // namespace pcavr
