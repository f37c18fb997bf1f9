// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// The kernels against plain formulas in double precision, on every instruction set.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/base/geometry/camera.hpp"

#include "perception/reconstruction/kernels.hpp"
#include "perception/reconstruction/noise_table_sizes.hpp"
#include "perception/reconstruction/noise_tables.hpp"

namespace pcavr {
namespace {

constexpr int kViewWidth = 61;
constexpr int kViewHeight = 43;
constexpr float kViewVoxel = 0.01F;

/// A frame of random surfaces near a depth of 1 m, and one without surface as the last.
std::vector<PixelSurface> random_surfaces(Random& random) {
  std::vector<PixelSurface> pixels(kViewWidth * kViewHeight + 1);
  for (std::size_t i = 0; i + 1 < pixels.size(); ++i) {
    const Eigen::Vector3d normal =
        Eigen::Vector3d(random.uniform(-0.7, 0.7), random.uniform(-0.7, 0.7), 1.0).normalized();
    for (int k = 0; k < 3; ++k) pixels[i].normal[k] = static_cast<float>(normal[k]);
    pixels[i].offset = static_cast<float>(normal.z() * random.uniform(0.94, 1.06));
    pixels[i].weight = static_cast<float>(random.uniform(1.0, 256.0));
    pixels[i].truncation = static_cast<float>(random.uniform(0.03, 0.05));
    pixels[i].free_depth = static_cast<float>(random.uniform(0.9, 1.1));
    pixels[i].color = static_cast<std::uint32_t>(1 + random.below(0xFFFFFFU));
  }
  return pixels;
}

/// A block near the depth of 1 m, in any orientation, in part outside the image.
BlockView random_view(Random& random, const std::vector<PixelSurface>& pixels) {
  BlockView view{};
  view.pixels = pixels.data();
  view.width = kViewWidth;
  view.height = kViewHeight;
  view.fx = 60.0F;
  view.fy = 55.0F;
  view.cx = 29.3F;
  view.cy = 21.7F;
  const Eigen::Matrix3d R =
      Eigen::Quaterniond(random.normal(), random.normal(), random.normal(), random.normal())
          .normalized()
          .toRotationMatrix();
  for (int k = 0; k < 3; ++k) {
    view.step_x[k] = static_cast<float>(R(k, 0)) * kViewVoxel;
    view.step_y[k] = static_cast<float>(R(k, 1)) * kViewVoxel;
    view.step_z[k] = static_cast<float>(R(k, 2)) * kViewVoxel;
  }
  view.origin[0] = static_cast<float>(random.uniform(-0.55, 0.55));
  view.origin[1] = static_cast<float>(random.uniform(-0.45, 0.45));
  view.origin[2] = static_cast<float>(random.uniform(0.9, 1.1));
  view.min_band_depth = 0.0F;
  view.max_band_depth = 9.0F;
  view.max_free_depth = 9.0F;
  view.steps_per_metre = kDistanceSteps / kViewVoxel;
  view.voxel_size = kViewVoxel;
  view.dither = static_cast<std::uint32_t>(random.bits());
  view.max_free_count = 3;
  return view;
}

/// One voxel by the formulas of the header, the README and Curless & Levoy (1996).
struct ReferenceVoxel {
  double distance = 0.0;  ///< [steps]
  double weight = 0.0;
  std::uint32_t hits = 0;
  std::uint32_t free = 0;
  std::array<double, 3> color{};
  bool is_uncertain = false;  ///< a comparison within float rounding

  /// Records a comparison of a with b.
  bool below(double a, double b, double rounding) {
    is_uncertain = is_uncertain || std::abs(a - b) < rounding;
    return a < b;
  }

  void fuse(const BlockView& view, int voxel) {
    const Eigen::Vector3d step_x(view.step_x[0], view.step_x[1], view.step_x[2]);
    const Eigen::Vector3d step_y(view.step_y[0], view.step_y[1], view.step_y[2]);
    const Eigen::Vector3d step_z(view.step_z[0], view.step_z[1], view.step_z[2]);
    const Eigen::Vector3d p = Eigen::Vector3d(view.origin[0], view.origin[1], view.origin[2]) +
                              voxel % 8 * step_x + voxel / 8 % 8 * step_y + voxel / 64 * step_z;
    const double u = view.fx * p.x() / p.z() + view.cx + 0.5;
    const double v = view.fy * p.y() / p.z() + view.cy + 0.5;
    is_uncertain = is_uncertain || std::abs(u - std::round(u)) < 1e-4;
    is_uncertain = is_uncertain || std::abs(v - std::round(v)) < 1e-4;
    if (u < 0.0 || v < 0.0 || u >= view.width || v >= view.height) return;
    const PixelSurface& pixel = view.pixels[static_cast<int>(v) * view.width + static_cast<int>(u)];
    if (below(p.z(), pixel.free_depth, 1e-6) && free < view.max_free_count) ++free;
    const double ahead =
        pixel.offset - Eigen::Vector3d(pixel.normal[0], pixel.normal[1], pixel.normal[2]).dot(p);
    const double truncation = pixel.truncation;
    if (below(truncation, ahead, 1e-6) || below(ahead, -truncation, 1e-6)) return;
    // Linear to zero over the last 0.4 of the band behind the surface, at least one unit.
    const double ramp = std::min(1.0, (ahead + truncation) / (0.4 * truncation));
    const double added = std::max(1.0, pixel.weight * ramp);
    const double fraction = added / (weight + added);
    distance += (ahead * kDistanceSteps / kViewVoxel - distance) * fraction;
    weight = std::min(weight + added, double{kMaxWeight});
    hits = std::min(hits + 1, kMaxCount);
    const double reach = 1.25 * kViewVoxel;
    if (!below(std::abs(ahead), reach, 1e-6)) return;
    const bool is_first = color == std::array<double, 3>{};
    for (std::size_t c = 0; c < 3; ++c) {
      const double measured = (pixel.color >> (8 * c)) & 255U;
      color[c] += (measured - color[c]) * (is_first ? 1.0 : fraction);
    }
  }
};

TEST(FuseBlock, AgreesWithTheFormulasOnEveryInstructionSet) {
  Random random(31);
  constexpr int kFrames = 6;
  int compared = 0;
  for (int trial = 0; trial < 40; ++trial) {
    std::vector<std::vector<PixelSurface>> frames;
    for (int f = 0; f < kFrames; ++f) frames.push_back(random_surfaces(random));
    BlockView view = random_view(random, frames[0]);
    std::vector<ReferenceVoxel> reference(kBlockVoxels);
    for (const std::vector<PixelSurface>& pixels : frames) {
      view.pixels = pixels.data();
      for (int i = 0; i < kBlockVoxels; ++i) reference[static_cast<std::size_t>(i)].fuse(view, i);
    }
    for (const Kernels* kernels : supported_kernels()) {
      VoxelBlock block{};
      for (const std::vector<PixelSurface>& pixels : frames) {
        view.pixels = pixels.data();
        kernels->fuse_block(view, block, nullptr);
      }
      for (std::size_t i = 0; i < kBlockVoxels; ++i) {
        const ReferenceVoxel& voxel = reference[i];
        if (voxel.is_uncertain) continue;
        ASSERT_EQ(hit_count(block.color_counts[i]), voxel.hits);
        ASSERT_EQ(free_count(block.color_counts[i]), voxel.free);
        // Each frame rounds the distance by at most half a step and the weight by half a unit;
        // dithering the colours, by less than one. The weight's error changes the fractions: with
        // an error of 3 of at least 1 unit they are not comparable, with one of 200 they differ by
        // less than 3 %, of measurements at most 2 * 0.05 m apart.
        ASSERT_NEAR(block.distance_weight[i] >> 16, voxel.weight, 0.5 * kFrames);
        if (voxel.hits == 0 || voxel.weight < 200.0) continue;
        const double tolerance = 0.5 * kFrames + 0.03 * 0.1 * kDistanceSteps / kViewVoxel;
        ASSERT_NEAR(distance_steps(block.distance_weight[i]), voxel.distance, tolerance);
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 1000);
}

TEST(FuseBlock, MeanOfOneSurfaceIsTheSurfaceAndItsWeightSaturates) {
  // The same frame again and again: the mean stays within a step of the measured distance, as
  // rounding is to nearest; also when the weight is at its maximum.
  Random random(32);
  for (const Kernels* kernels : supported_kernels()) {
    const std::vector<PixelSurface> pixels = random_surfaces(random);
    BlockView view = random_view(random, pixels);
    view.origin[0] = view.origin[1] = 0.0F;
    VoxelBlock once{};
    kernels->fuse_block(view, once, nullptr);
    VoxelBlock block{};
    for (int i = 0; i < 400; ++i) {
      view.dither = static_cast<std::uint32_t>(random.bits());
      kernels->fuse_block(view, block, nullptr);
    }
    int saturated = 0;
    for (std::size_t i = 0; i < kBlockVoxels; ++i) {
      const std::uint32_t weight = once.distance_weight[i] >> 16;
      EXPECT_NEAR(distance_steps(block.distance_weight[i]), distance_steps(once.distance_weight[i]),
                  1);
      // Rounded by half a unit in each frame.
      EXPECT_NEAR(block.distance_weight[i] >> 16, std::min(400U * weight, kMaxWeight), 200.0);
      EXPECT_EQ(hit_count(block.color_counts[i]), weight > 0 ? kMaxCount : 0U);
      saturated += block.distance_weight[i] >> 16 == kMaxWeight ? 1 : 0;
    }
    EXPECT_GT(saturated, 20);
  }
}

TEST(FuseBlock, RoundsDistancesWithoutBias) {
  // The mean of 200 random distances of one weight. Rounding to nearest adds an error with zero
  // mean and std 0.29 in each frame: of the last mean 0.29 sqrt(200 / 3) = 2.4 steps per voxel, of
  // the mean over 512 voxels 0.1. Bound: 1 step; any bias of a rounding is summed to 100 times.
  for (const Kernels* kernels : supported_kernels()) {
    Random random(35);
    std::vector<PixelSurface> pixels(kViewWidth * kViewHeight + 1);
    BlockView view = random_view(random, pixels);
    const std::array<float, 3> origin = {0.0F, 0.0F, 1.0F};
    std::copy(origin.begin(), origin.end(), view.origin);
    VoxelBlock block{};
    std::vector<ReferenceVoxel> reference(kBlockVoxels);
    for (int frame = 0; frame < 200; ++frame) {
      for (std::size_t i = 0; i + 1 < pixels.size(); ++i) {
        pixels[i].offset = static_cast<float>(1.1 + 0.02 * random.normal());
        pixels[i].weight = 256.0F;
        pixels[i].truncation = 1.0F;
      }
      kernels->fuse_block(view, block, nullptr);
      for (int i = 0; i < kBlockVoxels; ++i) reference[static_cast<std::size_t>(i)].fuse(view, i);
    }
    double sum = 0.0;
    int count = 0;
    for (std::size_t i = 0; i < kBlockVoxels; ++i) {
      if (reference[i].is_uncertain) continue;
      sum += distance_steps(block.distance_weight[i]) - reference[i].distance;
      ++count;
    }
    ASSERT_GT(count, 400);
    EXPECT_NEAR(sum / count, 0.0, 1.0);
  }
}

TEST(FuseBlock, ColorsStayWithinTheMeasuredOnes) {
  // Uniform colours: dithering by less than one changes a channel by at most one, and none beyond
  // 255, whatever the noise. A surface through the whole block, in 20 000 frames: 1e7 updates.
  for (const Kernels* kernels : supported_kernels()) {
    for (const std::uint32_t color : {0xFFFFFFU, 0xFF0001U, 0x80FF80U}) {
      std::vector<PixelSurface> pixels(kViewWidth * kViewHeight + 1);
      for (std::size_t i = 0; i + 1 < pixels.size(); ++i) {
        pixels[i].offset = 1.0F;
        pixels[i].weight = 256.0F;
        pixels[i].truncation = 0.05F;
        pixels[i].color = color;
      }
      Random random(33);
      BlockView view = random_view(random, pixels);
      const std::array<float, 3> origin = {-0.03F, -0.03F, 0.97F};
      std::copy(origin.begin(), origin.end(), view.origin);
      for (int k = 0; k < 3; ++k) {
        view.step_x[k] = k == 0 ? kViewVoxel : 0.0F;
        view.step_y[k] = k == 1 ? kViewVoxel : 0.0F;
        view.step_z[k] = k == 2 ? kViewVoxel : 0.0F;
      }
      view.voxel_size = 1.0F;  // colour within 1.25 m
      VoxelBlock block{};
      int out_of_range = 0;
      for (std::uint32_t frame = 0; frame < 20'000; ++frame) {
        view.dither = frame * 0x632BE5ABU;  // as the volume does
        kernels->fuse_block(view, block, nullptr);
        for (const std::uint32_t counts : block.color_counts) {
          for (const int shift : {0, 8, 16}) {
            const int difference = static_cast<int>((counts >> shift) & 255U) -
                                   static_cast<int>((color >> shift) & 255U);
            out_of_range += difference < -1 || difference > 1 ? 1 : 0;
          }
        }
      }
      EXPECT_EQ(out_of_range, 0) << std::hex << color;
      for (const std::uint32_t counts : block.color_counts) EXPECT_EQ(hit_count(counts), kMaxCount);
    }
  }
}

/// A row of pixels whose window is `inverse`, of the given noise tables.
PixelRow pixel_row(const std::vector<float>& inverse, int stride, int width,
                   const NoiseTables& tables, const std::vector<float>& free_depth,
                   const std::vector<std::uint32_t>& colors, double fx, double fy) {
  PixelRow row{};
  row.inverse = inverse.data() + kPlaneWindowRadius * stride + kPlaneWindowRadius;
  row.inverse_stride = stride;
  row.free_depth = free_depth.data();
  row.color = colors.data();
  row.width = width;
  row.ray_y = 0.11F;
  row.ray_x = -0.3F;
  row.ray_step = static_cast<float>(1.0 / fx);
  row.fx = static_cast<float>(fx);
  row.fy = static_cast<float>(fy);
  row.slope_tolerance = 0.1F;
  row.min_depth = tables.min_depth();
  row.steps_per_metre = tables.steps_per_metre();
  row.last_step = kNoiseDepths - 1;
  row.truncations = tables.truncations();
  row.inverse_tolerances = tables.inverse_tolerances();
  row.weights = tables.weights();
  return row;
}

TEST(FindSurfaces, FitsAPlaneThroughAnyWindowOnEveryInstructionSet) {
  const NoiseTables tables(DepthNoise{}, 0.04, 2.0);
  constexpr double kFx = 65.0;
  constexpr double kFy = 61.0;
  Random random(34);
  for (int trial = 0; trial < 200; ++trial) {
    // Widths with and without a part of a SIMD vector.
    const int width = 1 + static_cast<int>(random.below(40));
    const int stride = (width + 2 * kPlaneWindowRadius + 31) / 16 * 16;
    const Eigen::Vector3d normal =
        Eigen::Vector3d(random.uniform(-0.8, 0.8), random.uniform(-0.8, 0.8), 1.0).normalized();
    const double offset = normal.z() * random.uniform(0.8, 2.0);
    std::vector<float> inverse(static_cast<std::size_t>(5 * stride), 0.0F);
    for (int dv = -2; dv <= 2; ++dv) {
      for (int u = 0; u < width; ++u) {
        // A quarter of the pixels have no depth.
        if (random.below(4) == 0) continue;
        const Eigen::Vector3d ray(double{-0.3F} + u / kFx, double{0.11F} + dv / kFy, 1.0);
        inverse[static_cast<std::size_t>((dv + 2) * stride + 2 + u)] =
            static_cast<float>(normal.dot(ray) / offset);
      }
    }
    std::vector<float> free_depth;
    std::vector<std::uint32_t> colors;
    for (int u = 0; u < width; ++u) {
      free_depth.push_back(static_cast<float>(random.uniform(0.0, 1.0)));
      colors.push_back(static_cast<std::uint32_t>(random.below(1U << 24)));
    }
    const PixelRow row = pixel_row(inverse, stride, width, tables, free_depth, colors, kFx, kFy);
    std::vector<PixelSurface> baseline;
    for (const Kernels* kernels : supported_kernels()) {
      std::vector<PixelSurface> pixels(static_cast<std::size_t>(width));
      kernels->find_surfaces(row, pixels.data());
      if (baseline.empty()) baseline = pixels;
      ASSERT_EQ(std::memcmp(pixels.data(), baseline.data(), pixels.size() * sizeof(PixelSurface)),
                0);
    }
    for (int u = 0; u < width; ++u) {
      const PixelSurface& pixel = baseline[static_cast<std::size_t>(u)];
      ASSERT_EQ(pixel.free_depth, free_depth[static_cast<std::size_t>(u)]);
      ASSERT_EQ(pixel.color, colors[static_cast<std::size_t>(u)]);
      const float q = row.inverse[u];
      if (q == 0.0F) {
        ASSERT_LT(pixel.offset, -1e8F);
        continue;
      }
      // The measured point lies on its plane, whatever the fit is: 1e-5 relative rounding.
      const Eigen::Vector3d n(pixel.normal[0], pixel.normal[1], pixel.normal[2]);
      const Eigen::Vector3d ray(double{-0.3F} + u / kFx, double{0.11F}, 1.0);
      ASSERT_NEAR(n.norm(), 1.0, 1e-5);
      ASSERT_NEAR(n.dot(ray) / double{q}, pixel.offset, 2e-5);
      // Well determined: at least ten pixels of the window, over three rows and columns. Rounding
      // of inverse depth, 6e-8, is amplified by less than fx over a window.
      int count = 0;
      unsigned rows = 0;
      unsigned columns = 0;
      for (int dv = -2; dv <= 2; ++dv) {
        for (int du = -2; du <= 2; ++du) {
          if (row.inverse[dv * stride + u + du] == 0.0F) continue;
          ++count;
          rows |= 1U << (dv + 2);
          columns |= 1U << (du + 2);
        }
      }
      if (count < 10 || __builtin_popcount(rows) < 3 || __builtin_popcount(columns) < 3) continue;
      ASSERT_GT(n.dot(normal), 1.0 - 1e-6);
      ASSERT_NEAR(pixel.offset, offset, 1e-4);
      ASSERT_EQ(pixel.truncation, tables.truncation(1.0F / q));
      // Weight: inverse to the variance, of which the tables' steps are below 10 % here (64
      // cosines, depths of 20 mm).
      const double cosine = n.dot(ray) / ray.norm();
      const DepthNoise noise;
      const double ratio = noise.constant / noise.depth_std(1.0 / double{q}, std::acos(cosine));
      ASSERT_NEAR(pixel.weight / (256.0 * ratio * ratio), 1.0, 0.1);
    }
  }
}

}  // namespace
}  // namespace pcavr
