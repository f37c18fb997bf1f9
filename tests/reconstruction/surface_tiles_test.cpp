// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/reconstruction/surface_tiles.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/random.hpp"
#include "pcavr/perception/reconstruction/frame_reach.hpp"
#include "pcavr/perception/reconstruction/measured_cloud.hpp"
#include "pcavr/perception/reconstruction/tsdf_part.hpp"

#include "reconstruction/depth_scenes.hpp"

namespace pcavr {
namespace {

constexpr double kTileVoxel = 0.02;  // [m]
constexpr int kTileSide = 7;         // [blocks]: 1.12 m

struct View {
  DepthImage depth;
  ColorImage color;
  Pose T_base_camera;
};

/// Along a corridor of 6 x 3 x 2.4 m with a ball in it, seen by noise; for a while something stands
/// in the way.
std::vector<View> corridor(const CameraModel& camera) {
  using test::nearest_of;
  using test::plane;
  test::Surface walls = plane({0.0, 0.0, -1.0}, 0.0);  // the floor
  const std::pair<Eigen::Vector3d, double> others[] = {{{0.0, 0.0, 1.0}, 2.4},
                                                       {{1.0, 0.0, 0.0}, 6.0},
                                                       {{-1.0, 0.0, 0.0}, 0.0},
                                                       {{0.0, 1.0, 0.0}, 1.5},
                                                       {{0.0, -1.0, 0.0}, 1.5}};
  for (const auto& [normal, offset] : others) walls = nearest_of(walls, plane(normal, offset));
  const test::Surface scene = nearest_of(walls, test::sphere({3.1, -0.3, 0.8}, 0.4));
  const test::Surface blocked = nearest_of(scene, test::sphere({2.0, 0.6, 1.0}, 0.3));
  Random random(7);
  std::vector<View> views;
  for (int i = 0; i < 80; ++i) {
    const double x = 0.6 + 0.06 * i;
    const double yaw = 0.9 * i;
    const Eigen::Vector3d eye(x, 0.3 * std::sin(i), 1.2);
    const Pose pose =
        test::looking_at(eye, eye + Eigen::Vector3d(std::cos(yaw), std::sin(yaw), -0.3));
    View view{test::depth_of(i / 10 == 2 ? blocked : scene, camera, pose),
              ColorImage(camera.width, camera.height), pose};
    for (float& z : view.depth.pixels()) z += 0.003F * z * static_cast<float>(random.normal());
    for (Rgb8& pixel : view.color.pixels()) {
      pixel = {static_cast<std::uint8_t>(random.uniform(0.0, 255.0)), 90,
               static_cast<std::uint8_t>(3 * i)};
    }
    views.push_back(std::move(view));
  }
  return views;
}

/// Squares from above, in a shuffled order of no meaning.
std::vector<BlockBox> corridor_tiles() {
  std::vector<BlockBox> tiles;
  for (int x = 6; x >= -2; --x) {
    for (int y = -3; y <= 2; ++y) {
      tiles.push_back(
          {{x * kTileSide, y * kTileSide, -60}, {(x + 1) * kTileSide, (y + 1) * kTileSide, 60}});
    }
  }
  return tiles;
}

/// Three corners with position, normal and colour; the first is the smallest.
using Corner = std::array<float, 9>;
std::vector<std::array<Corner, 3>> sorted_triangles(const TriangleMesh& mesh) {
  std::vector<std::array<Corner, 3>> all;
  for (const auto& t : mesh.triangles) {
    std::array<Corner, 3> triangle;
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector3f& p = mesh.vertices.at(t[i]);
      const Eigen::Vector3f& n = mesh.normals.at(t[i]);
      const Rgb8 c = mesh.colors.at(t[i]);
      triangle[i] = {p.x(),
                     p.y(),
                     p.z(),
                     n.x(),
                     n.y(),
                     n.z(),
                     static_cast<float>(c.r),
                     static_cast<float>(c.g),
                     static_cast<float>(c.b)};
    }
    std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()),
                triangle.end());
    all.push_back(triangle);
  }
  std::sort(all.begin(), all.end());
  return all;
}

struct TiledFusion {
  std::vector<SurfaceTile> tiles;
  std::size_t seen = 0;  ///< frames, over all tiles
  std::size_t unseen = 0;
  std::size_t max_blocks = 0;
};

TiledFusion fuse_by_tiles(const std::vector<View>& views, const CameraModel& camera,
                          const SurfaceEvidence& evidence) {
  const TsdfOptions options(kTileVoxel);
  const ReachFinder finder(camera, options);
  std::vector<FrameReach> reaches;
  for (const View& view : views) reaches.push_back(finder.reach_of(view.depth, view.T_base_camera));
  TiledFusion fused;
  for (const BlockBox& tile : corridor_tiles()) {
    const BlockBox kept = tile.expanded(1);
    const Eigen::AlignedBox3d box(kept.low.cast<double>() * 8 * kTileVoxel,
                                  kept.high.cast<double>() * 8 * kTileVoxel);
    TsdfPart volume(options, tile);
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (!finder.sees(reaches[i], box)) {
        ++fused.unseen;
        volume.integrate_unseen();
        continue;
      }
      ++fused.seen;
      volume.integrate(views[i].depth, views[i].color, {}, camera, views[i].T_base_camera, {1});
    }
    fused.max_blocks = std::max(fused.max_blocks, volume.block_count());
    fused.tiles.push_back(volume.extract_tile(evidence, {1}));
  }
  return fused;
}

TsdfVolume fuse_at_once(const std::vector<View>& views, const CameraModel& camera) {
  TsdfVolume volume(TsdfOptions{kTileVoxel});
  for (const View& view : views) {
    volume.integrate(view.depth, view.color, {}, camera, view.T_base_camera, {1});
  }
  return volume;
}

void expect_equal_by_tiles(const CameraModel& camera) {
  const std::vector<View> views = corridor(camera);
  const SurfaceEvidence evidence{2.0, 1.0};
  const TsdfVolume whole = fuse_at_once(views, camera);
  TiledFusion fused = fuse_by_tiles(views, camera, evidence);
  std::size_t borrowed = 0;
  for (const SurfaceTile& tile : fused.tiles) borrowed += tile.borrowed.size();
  EXPECT_GT(borrowed, 1000U) << "no surface crosses a border";
  EXPECT_GT(fused.unseen, fused.seen / 5) << "all frames are read for all tiles";
  EXPECT_LT(fused.max_blocks, whole.block_count() / 3);
  const TriangleMesh expected = whole.extract_mesh(evidence, {1});
  const TriangleMesh mesh = joined(std::move(fused.tiles));
  EXPECT_EQ(mesh.vertices.size(), expected.vertices.size());
  ASSERT_GT(mesh.triangles.size(), 100'000U);
  EXPECT_TRUE(sorted_triangles(mesh) == sorted_triangles(expected));
}

TEST(SurfaceTiles, JoinToTheMeshOfTheWholeToTheBit) { expect_equal_by_tiles(test::small_camera()); }

TEST(SurfaceTiles, JoinToTheMeshOfTheWholeOfADistortedLens) {
  CameraModel camera = test::small_camera();
  camera.distortion = {-0.2, 0.05, 0.001, -0.001, 0.0};
  expect_equal_by_tiles(camera);
}

TEST(SurfaceTiles, OfWhichOneIsMissingCanNotBeJoined) {
  const CameraModel camera = test::small_camera();
  TiledFusion fused = fuse_by_tiles(corridor(camera), camera, {2.0, 2.0});
  const auto lender =
      std::max_element(fused.tiles.begin(), fused.tiles.end(),
                       [](const auto& a, const auto& b) { return a.lent.size() < b.lent.size(); });
  fused.tiles.erase(lender);
  EXPECT_THROW(static_cast<void>(joined(std::move(fused.tiles))), ContractError);
}

TEST(SurfaceTiles, HaveThePointsOfTheWholeCloud) {
  const CameraModel camera = test::small_camera();
  const std::vector<View> views = corridor(camera);
  const BlockBox tile{{kTileSide, -kTileSide, -60}, {2 * kTileSide, 0, 60}};
  MeasuredCloud whole(kTileVoxel, {});
  MeasuredCloud part(kTileVoxel, {}, tile);
  const ReachFinder finder(camera, TsdfOptions{kTileVoxel});
  const BlockBox kept = tile.expanded(1);
  const Eigen::AlignedBox3d box(kept.low.cast<double>() * 8 * kTileVoxel,
                                kept.high.cast<double>() * 8 * kTileVoxel);
  int unseen = 0;
  for (const View& view : views) {
    whole.add(view.depth, view.color, {}, camera, view.T_base_camera);
    if (finder.sees(finder.reach_of(view.depth, view.T_base_camera), box)) {
      part.add(view.depth, view.color, {}, camera, view.T_base_camera);
    } else {
      ++unseen;
      part.add_unseen();
    }
  }
  EXPECT_GT(unseen, 0);
  EXPECT_LT(part.voxel_count(), whole.voxel_count() / 5);
  const PointCloud expected = points_in(whole.points(2), tile, kTileVoxel);
  const PointCloud points = points_in(part.points(2), tile, kTileVoxel);
  ASSERT_GT(points.points.size(), 200U);
  EXPECT_EQ(points.points, expected.points);
  EXPECT_EQ(points.normals, expected.normals);
  EXPECT_EQ(points.colors, expected.colors);
}

}  // namespace
}  // namespace pcavr
