// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Which blocks a frame affects, against projecting every voxel.
#include "perception/reconstruction/block_selection.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

#include "perception/reconstruction/past_views.hpp"
#include "reconstruction/depth_scenes.hpp"

namespace pcavr {
namespace {

const CameraModel kSelectionCamera = test::small_camera();

Pose random_pose(Random& random) {
  const Eigen::Quaterniond q(random.normal(), random.normal(), random.normal(), random.normal());
  return {q.normalized(), Eigen::Vector3d(random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0),
                                          random.uniform(-2.0, 2.0))};
}

/// A sphere in front of a slanted wall, in camera axes, with an area of no depth, and in half of
/// the scenes with single pixels of no depth.
DepthImage random_scene(Random& random) {
  const Eigen::Vector3d normal =
      Eigen::Vector3d(random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6), 1.0).normalized();
  const Eigen::Vector3d centre(random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), 0.8);
  DepthImage depth =
      test::depth_of(test::nearest_of(test::sphere(centre, random.uniform(0.1, 0.25)),
                                      test::plane(normal, normal.z() * random.uniform(1.0, 2.5))),
                     kSelectionCamera, Pose());
  const bool has_holes = random.below(2) == 0;
  for (float& z : depth.pixels()) z = has_holes && random.below(50) == 0 ? 0.0F : z;
  const int end = static_cast<int>(random.below(160));
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 0; u < end / 2; ++u) depth(u, v) = 0.0F;
  }
  return depth;
}

FrameSurface frame_of(const DepthImage& depth, const NoiseTables& tables) {
  FrameSurface frame;
  prepare_frame(depth, {}, {}, kSelectionCamera, tables, {1}, frame);
  return frame;
}

TEST(BlocksNearSurface, ContainEveryMeasuredPointOnce) {
  Random random(41);
  for (const double voxel : {0.004, 0.01, 0.05}) {
    for (int trial = 0; trial < 5; ++trial) {
      const NoiseTables tables(DepthNoise{}, 4.0 * voxel, 2.0);
      const FrameSurface frame = frame_of(random_scene(random), tables);
      const Pose T_base_camera = random_pose(random);
      const std::vector<BlockCoordinates> blocks =
          blocks_near_surface(frame, T_base_camera, tables, voxel, {1});
      EXPECT_EQ(blocks_near_surface(frame, T_base_camera, tables, voxel, {3}), blocks);
      BlockHashTable known;
      for (std::uint32_t i = 0; i < blocks.size(); ++i) {
        ASSERT_EQ(known.find(blocks[i]), BlockHashTable::kNone);
        known.insert(blocks[i], i);
      }
      // Rays are at most a quarter of a block apart and steps along them half a block: a block may
      // be missed where a ray passes through its corner only, i.e. within these distances of its
      // border.
      const double block = kBlockSide * voxel;
      for (int v = 0; v < frame.depth.height(); ++v) {
        for (int u = 0; u < frame.depth.width(); ++u) {
          const double z = frame.depth(u, v);
          if (z == 0.0) continue;
          const Eigen::Vector3d p = T_base_camera * frame.camera.unproject({u, v}, z) / block;
          const Eigen::Vector3d inside = p - p.array().floor().matrix();
          if (inside.minCoeff() < 0.3 || inside.maxCoeff() > 0.7) continue;
          const Eigen::Vector3i at = p.array().floor().cast<int>();
          ASSERT_NE(known.find({at.x(), at.y(), at.z()}), BlockHashTable::kNone);
        }
      }
    }
  }
}

/// A map of the blocks near some frames' surfaces, and in the space between.
BlockMap map_of(const FrameSurface& frame, const Pose& T_base_camera, const NoiseTables& tables,
                double voxel, Random& random) {
  BlockMap map;
  for (const BlockCoordinates& block :
       blocks_near_surface(frame, T_base_camera, tables, voxel, {1})) {
    map.add(block);
  }
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d p_camera(random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5),
                                   random.uniform(-0.5, 3.0));
    const Eigen::Vector3i at =
        (T_base_camera * p_camera / (kBlockSide * voxel)).array().floor().cast<int>();
    if (map.find({at.x(), at.y(), at.z()}) == BlockHashTable::kNone) {
      map.add({at.x(), at.y(), at.z()});
    }
  }
  return map;
}

TEST(VisibleBlocks, AreAllWithAVoxelThatTheFrameAffects) {
  Random random(42);
  constexpr double kVoxel = 0.01;
  // Float rounding of coordinates of up to 5 m, and of pixels, to be skipped.
  constexpr double kRounding = 1e-5;
  int affected = 0;
  int entirely_free = 0;
  for (int trial = 0; trial < 10; ++trial) {
    const NoiseTables tables(DepthNoise{}, 4.0 * kVoxel, 2.0);
    const FrameSurface frame = frame_of(random_scene(random), tables);
    const Pose T_base_camera = random_pose(random);
    const BlockMap map = map_of(frame, T_base_camera, tables, kVoxel, random);
    std::vector<const VisibleBlock*> visible(map.size(), nullptr);
    const std::vector<VisibleBlock> found =
        visible_blocks(map, frame, T_base_camera, tables, kVoxel);
    for (const VisibleBlock& block : found) {
      ASSERT_EQ(visible[block.number], nullptr);
      visible[block.number] = &block;
    }
    const Pose T_camera_base = T_base_camera.inverse();
    for (std::uint32_t number = 0; number < map.size(); ++number) {
      const BlockCoordinates& at = map.coordinates(number);
      for (int i = 0; i < kBlockVoxels; ++i) {
        const Eigen::Vector3d p =
            T_camera_base *
            (kVoxel * Eigen::Vector3d(at.x * 8 + i % 8, at.y * 8 + i / 8 % 8, at.z * 8 + i / 64));
        const bool is_projected = p.z() > 0.0;
        const Eigen::Vector2d pixel =
            is_projected ? frame.camera.project(p) : Eigen::Vector2d(-9.0, -9.0);
        const Eigen::Vector2d nearest = pixel.array().round();
        const bool is_seen =
            frame.depth.contains(static_cast<int>(nearest.x()), static_cast<int>(nearest.y())) &&
            ((pixel - nearest).cwiseAbs().array() < 0.5 - 1e-4).all();
        const int u = static_cast<int>(nearest.x());
        const int v = static_cast<int>(nearest.y());
        const double depth = is_seen ? frame.depth(u, v) : 0.0;
        const double free_depth = is_seen ? frame.free_depth(u, v) : 0.0;
        const bool is_free = is_seen && p.z() < free_depth - kRounding;
        const bool is_in_band =
            depth > 0.0 &&
            std::abs(p.z() - depth) < double{tables.truncation(frame.depth(u, v))} - kRounding;
        const VisibleBlock* block = visible[number];
        if (is_seen && block != nullptr && block->is_entirely_free) {
          ASSERT_LT(p.z(), free_depth + kRounding) << "not free at " << pixel.transpose();
          ++entirely_free;
        }
        if (!is_free && !is_in_band) continue;
        ++affected;
        ASSERT_NE(block, nullptr) << p.transpose() << " at " << pixel.transpose();
        if (is_free) {
          ASSERT_LT(p.z(), block->max_free_depth);
        } else {
          ASSERT_GT(p.z(), block->min_band_depth);
          ASSERT_LT(p.z(), block->max_band_depth);
        }
      }
    }
  }
  EXPECT_GT(affected, 100'000);
  EXPECT_GT(entirely_free, 10'000);
}

TEST(PastViews, CountTheViewsThatObservedAVoxelAsFree) {
  Random random(43);
  constexpr double kVoxel = 0.01;
  const NoiseTables tables(DepthNoise{}, 4.0 * kVoxel, 2.0);
  for (int trial = 0; trial < 5; ++trial) {
    constexpr int kViews = 12;
    std::vector<FrameSurface> frames;
    std::vector<Pose> poses;
    PastViews views;
    for (int i = 0; i < kViews; ++i) {
      frames.push_back(frame_of(random_scene(random), tables));
      poses.push_back(test::looking_at({random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), -1.0},
                                       {random.uniform(-0.3, 0.3), 0.0, 0.0}));
      views.add(frames.back(), poses.back());
    }
    for (int b = 0; b < 200; ++b) {
      const auto draw = [&] { return static_cast<int>(random.below(20)) - 10; };
      const int x = draw();
      const int y = draw();
      const BlockCoordinates at{x, y, draw() - 4};
      VoxelBlock block{};
      views.count_free_views(at, kVoxel, block);
      for (int i = 0; i < kBlockVoxels; ++i) {
        const Eigen::Vector3d p_base =
            kVoxel * Eigen::Vector3d(at.x * 8 + i % 8, at.y * 8 + i / 8 % 8, at.z * 8 + i / 64);
        // Depth is stored in units of 0.25 mm, rounded down; pixels may be rounded either way.
        std::uint32_t certain = 0;
        std::uint32_t possible = 0;
        for (std::size_t k = 0; k < kViews; ++k) {
          const Eigen::Vector3d p = poses[k].inverse() * p_base;
          if (p.z() <= 0.0) continue;
          const Eigen::Vector2d pixel = frames[k].camera.project(p);
          const Eigen::Vector2d nearest = pixel.array().round();
          const int u = static_cast<int>(nearest.x());
          const int v = static_cast<int>(nearest.y());
          const bool is_between = ((pixel - nearest).cwiseAbs().array() > 0.5 - 1e-4).any();
          if (is_between) ++possible;
          if (is_between || !frames[k].free_depth.contains(u, v)) continue;
          const double free_depth = frames[k].free_depth(u, v);
          certain += p.z() < free_depth - 0.00026 ? 1 : 0;
          possible += p.z() < free_depth + 1e-5 ? 1 : 0;
        }
        const std::uint32_t count = free_count(block.color_counts[static_cast<std::size_t>(i)]);
        ASSERT_GE(count, std::min(certain, kMaxCount));
        ASSERT_LE(count, possible);
      }
    }
  }
}

TEST(PrepareFrame, FreeSpaceEndsBeforeEveryMeasurementAround) {
  Random random(44);
  const NoiseTables tables(DepthNoise{}, 0.04, 2.0);
  int free_pixels = 0;
  for (int trial = 0; trial < 20; ++trial) {
    DepthImage depth = random_scene(random);
    for (float& z : depth.pixels()) {
      const std::uint64_t chosen = random.below(300);
      if (chosen == 0) z = std::numeric_limits<float>::quiet_NaN();
      if (chosen == 1) z = -1.0F;
    }
    const FrameSurface frame = frame_of(depth, tables);
    for (int v = 0; v < frame.free_depth.height(); ++v) {
      for (int u = 0; u < frame.free_depth.width(); ++u) {
        const double free_depth = frame.free_depth(u, v);
        if (free_depth == 0.0) continue;
        ++free_pixels;
        // All 6 x 6 pixels of the 3 x 3 pooled ones are valid, and farther by the noise model's
        // margin; the tables' steps change it by less than 1 %, 1 mm.
        for (int y = 2 * v - 2; y < 2 * v + 4; ++y) {
          for (int x = 2 * u - 2; x < 2 * u + 4; ++x) {
            ASSERT_TRUE(depth.contains(x, y));
            const double z = depth(x, y);
            const double depth_std = DepthNoise{}.depth_std(z);
            const double margin = std::max(0.04, 2.0 * depth_std) + 3.0 * depth_std;
            ASSERT_LT(free_depth, z - margin + 0.001);
          }
        }
      }
    }
  }
  EXPECT_GT(free_pixels, 10'000);
}

}  // namespace
}  // namespace pcavr
