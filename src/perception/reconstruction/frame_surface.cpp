// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/reconstruction/frame_surface.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "perception/reconstruction/kernels.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kSurfaceGrainRows = 32;  // amortises the scheduling of a task
// The window of the plane fit accepts surfaces up to this incidence.
constexpr double kMaxFitIncidence = 70.0 * std::numbers::pi / 180.0;

/// Depth in range; 0 elsewhere.
DepthImage depth_in_range(const DepthImage& depth, const DepthNoise& noise) {
  DepthImage used(depth.width(), depth.height());
  const auto min_depth = static_cast<float>(noise.min_depth);
  const auto max_depth = static_cast<float>(noise.max_depth);
  const std::span<const float> from = depth.pixels();
  const std::span<float> to = used.pixels();
  // The condition is false for NaN, too.
  for (std::size_t i = 0; i < from.size(); ++i) {
    to[i] = from[i] >= min_depth && from[i] <= max_depth ? from[i] : 0.0F;
  }
  return used;
}

void remove_masked(const MaskImage& is_dynamic, DepthImage& depth) {
  const std::span<float> to = depth.pixels();
  for (std::size_t i = 0; i < is_dynamic.pixels().size(); ++i) {
    if (is_dynamic.pixels()[i] != 0) to[i] = 0.0F;
  }
}

/// Pools 2x2 pixels with one of the kernels.
DepthImage pooled(const DepthImage& used, decltype(Kernels::pool_depth) pool) {
  DepthImage half(used.width() / 2, used.height() / 2);
  for (int v = 0; v < half.height(); ++v) {
    pool(used.row(2 * v).data(), used.row(2 * v + 1).data(), half.width(), half.row(v).data());
  }
  return half;
}

/// Inverse depth, padded by kPlaneWindowRadius empty pixels.
struct PaddedInverse {
  explicit PaddedInverse(const DepthImage& depth)
      // Rows are padded to whole SIMD vectors, so that a vector may be loaded at any pixel.
      : stride((depth.width() + 2 * kPlaneWindowRadius + 31) / 16 * 16),
        values(static_cast<std::size_t>(stride * (depth.height() + 2 * kPlaneWindowRadius)), 0.0F) {
    for (int v = 0; v < depth.height(); ++v) {
      float* to = row(v);
      const std::span<const float> from = depth.row(v);
      for (std::size_t u = 0; u < from.size(); ++u) to[u] = from[u] > 0.0F ? 1.0F / from[u] : 0.0F;
    }
  }
  [[nodiscard]] float* row(int v) {
    return values.data() + (v + kPlaneWindowRadius) * stride + kPlaneWindowRadius;
  }
  int stride;
  std::vector<float> values;
};

/// Space in front of a measurement by its truncation and noise is free, if that holds over 3x3 of
/// the downsampled pixels (erosion). That is a margin of two full pixels on each side, about as far
/// as a pose error of 0.2 deg moves an edge.
DepthImage find_free_depth(const DepthImage& min_depth, const NoiseTables& tables) {
  const int width = min_depth.width();
  const int height = min_depth.height();
  // Separable 3x3 minimum; outside the image nothing is known.
  DepthImage rows(width, height, 0.0F);
  for (int v = 1; v + 1 < height; ++v) {
    const float* above = min_depth.row(v - 1).data();
    const float* here = min_depth.row(v).data();
    const float* below = min_depth.row(v + 1).data();
    float* to = rows.row(v).data();
    for (int u = 0; u < width; ++u) to[u] = std::min(std::min(above[u], here[u]), below[u]);
  }
  DepthImage free_depth(width, height, 0.0F);
  for (int v = 1; v + 1 < height; ++v) {
    const float* row = rows.row(v).data();
    float* to = free_depth.row(v).data();
    for (int u = 1; u + 1 < width; ++u) {
      const float z = std::min(std::min(row[u - 1], row[u]), row[u + 1]);
      to[u] = std::max(0.0F, z - tables.free_margin(z));
    }
  }
  return free_depth;
}

DepthTile summarise(const FrameSurface& frame, int tile_x, int tile_y) {
  constexpr int kTile = FrameSurface::kTile;
  DepthTile tile;
  const int u_end = std::min((tile_x + 1) * kTile, frame.depth.width());
  const int v_end = std::min((tile_y + 1) * kTile, frame.depth.height());
  for (int v = tile_y * kTile; v < v_end; ++v) {
    for (int u = tile_x * kTile; u < u_end; ++u) {
      const float z = frame.depth(u, v);
      tile.min_depth = std::min(tile.min_depth, z > 0.0F ? z : 1e9F);
      tile.max_depth = std::max(tile.max_depth, z);
      tile.min_free = std::min(tile.min_free, frame.free_depth(u, v));
      tile.max_free = std::max(tile.max_free, frame.free_depth(u, v));
    }
  }
  return tile;
}

void summarise_tiles(FrameSurface& frame) {
  frame.tiles_x = (frame.depth.width() + FrameSurface::kTile - 1) / FrameSurface::kTile;
  frame.tiles_y = (frame.depth.height() + FrameSurface::kTile - 1) / FrameSurface::kTile;
  frame.tiles.clear();
  frame.tiles.reserve(static_cast<std::size_t>(frame.tiles_x * frame.tiles_y));
  for (int y = 0; y < frame.tiles_y; ++y) {
    for (int x = 0; x < frame.tiles_x; ++x) frame.tiles.push_back(summarise(frame, x, y));
  }
}

PixelRow row_template(const CameraModel& camera, const NoiseTables& tables) {
  PixelRow row{};
  row.width = camera.width;
  row.ray_x = static_cast<float>(-camera.cx / camera.fx);
  row.ray_step = static_cast<float>(1.0 / camera.fx);
  row.fx = static_cast<float>(camera.fx);
  row.fy = static_cast<float>(camera.fy);
  row.slope_tolerance =
      static_cast<float>(std::tan(kMaxFitIncidence) * kPlaneWindowRadius / camera.fx);
  row.min_depth = tables.min_depth();
  row.steps_per_metre = tables.steps_per_metre();
  row.last_step = kNoiseDepths - 1;
  row.truncations = tables.truncations();
  row.inverse_tolerances = tables.inverse_tolerances();
  row.weights = tables.weights();
  return row;
}

}  // namespace

void prepare_frame(const DepthImage& depth, const ColorImage& color, const MaskImage& is_dynamic,
                   const CameraModel& camera, const NoiseTables& tables, Parallelism parallelism,
                   FrameSurface& frame) {
  DepthImage used = depth_in_range(depth, tables.noise());
  frame.camera = camera.downsampled(2);
  // Dynamic pixels add no surface, but the space in front of them is free.
  frame.free_depth = find_free_depth(pooled(used, kernels().pool_min), tables);
  remove_masked(is_dynamic, used);
  frame.pixels_used = static_cast<std::size_t>(
      std::count_if(used.pixels().begin(), used.pixels().end(), [](float z) { return z > 0.0F; }));
  frame.depth = pooled(used, kernels().pool_depth);
  summarise_tiles(frame);
  const int width = frame.depth.width();
  const std::size_t pixels = frame.depth.pixels().size() + 1;
  if (frame.pixels.size() != pixels) frame.pixels.assign(pixels, PixelSurface{});
  // The one of all voxels outside the image, those behind the camera too: it sees none of them.
  frame.pixels.back().free_depth = -1e9F;
  PaddedInverse inverse(frame.depth);
  const PixelRow first = row_template(frame.camera, tables);
  parallel_for(parallelism, static_cast<std::size_t>(frame.depth.height()), kSurfaceGrainRows,
               [&](std::size_t begin, std::size_t end) {
                 std::vector<std::uint32_t> colors(static_cast<std::size_t>(width), 0U);
                 PixelRow row = first;
                 row.inverse_stride = inverse.stride;
                 for (int v = static_cast<int>(begin); v < static_cast<int>(end); ++v) {
                   row.inverse = inverse.row(v);
                   row.free_depth = frame.free_depth.row(v).data();
                   row.ray_y = static_cast<float>((v - frame.camera.cy) / frame.camera.fy);
                   if (!color.empty()) {
                     kernels().pool_colors(&color.row(2 * v)[0].r, &color.row(2 * v + 1)[0].r,
                                           width, colors.data());
                   }
                   row.color = colors.data();
                   kernels().find_surfaces(row, frame.pixels.data() + v * width);
                 }
               });
}

}  // namespace pcavr
