// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "reconstruction/frame_surface.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reconstruction/kernels.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kGrainRows = 32;
// The window of the plane fit takes in surfaces up to this steep.
constexpr double kSteepestFit = 70.0 * std::numbers::pi / 180.0;

std::size_t count_used_readings(const DepthImage& depth, const MaskImage& is_dynamic,
                                const DepthNoise& noise, DepthImage& used) {
  used = DepthImage(depth.width(), depth.height());
  const auto nearest = static_cast<float>(noise.nearest);
  const auto farthest = static_cast<float>(noise.farthest);
  const std::span<const float> from = depth.pixels();
  const std::span<float> to = used.pixels();
  std::size_t count = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    // Also false for NaN.
    const bool is_used = from[i] >= nearest && from[i] <= farthest;
    to[i] = is_used ? from[i] : 0.0F;
  }
  if (!is_dynamic.empty()) {
    for (std::size_t i = 0; i < from.size(); ++i) {
      if (is_dynamic.pixels()[i] != 0) to[i] = 0.0F;
    }
  }
  for (const float z : to) count += z > 0.0F ? 1 : 0;
  return count;
}

/// Inverse depth with kPlaneReach empty pixels around it.
struct PaddedInverse {
  explicit PaddedInverse(const DepthImage& depth)
      // Rows end on whole vectors, so that a vector may be loaded at any pixel.
      : stride((depth.width() + 2 * kPlaneReach + 15) / 8 * 8),
        values(static_cast<std::size_t>(stride * (depth.height() + 2 * kPlaneReach)), 0.0F) {
    for (int v = 0; v < depth.height(); ++v) {
      float* to = row(v);
      const std::span<const float> from = depth.row(v);
      for (std::size_t u = 0; u < from.size(); ++u) to[u] = from[u] > 0.0F ? 1.0F / from[u] : 0.0F;
    }
  }
  [[nodiscard]] float* row(int v) {
    return values.data() + (v + kPlaneReach) * stride + kPlaneReach;
  }
  int stride;
  std::vector<float> values;
};

/// What is nearer than a measurement by its truncation and noise is free, if that holds over the
/// whole neighbourhood: pixels are pooled two by two, then the pools three by three. That guards
/// two pixels to every side, about as far as 0.2 deg of pose error move an edge.
DepthImage find_free_depth(const DepthImage& depth, const NoiseTables& tables) {
  const int width = (depth.width() + 1) / 2;
  const int height = (depth.height() + 1) / 2;
  DepthImage pooled(width, height, 0.0F);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const int u1 = std::min(2 * u + 1, depth.width() - 1);
      const int v1 = std::min(2 * v + 1, depth.height() - 1);
      const float z = std::min(std::min(depth(2 * u, 2 * v), depth(u1, 2 * v)),
                               std::min(depth(2 * u, v1), depth(u1, v1)));
      if (z > 0.0F) pooled(u, v) = std::max(0.0F, z - tables.free_margin(z));
    }
  }
  // Least of three rows, then of three columns; outside the image nothing is known.
  DepthImage rows(width, height, 0.0F);
  for (int v = 1; v + 1 < height; ++v) {
    for (int u = 0; u < width; ++u) {
      rows(u, v) = std::min(std::min(pooled(u, v - 1), pooled(u, v)), pooled(u, v + 1));
    }
  }
  DepthImage least(width, height, 0.0F);
  for (int v = 1; v + 1 < height; ++v) {
    for (int u = 1; u + 1 < width; ++u) {
      least(u, v) = std::min(std::min(rows(u - 1, v), rows(u, v)), rows(u + 1, v));
    }
  }
  return least;
}

DepthTile summarise(const FrameSurface& frame, int tile_x, int tile_y) {
  constexpr int kTile = FrameSurface::kTile;
  DepthTile tile;
  const int u_end = std::min((tile_x + 1) * kTile, frame.width);
  const int v_end = std::min((tile_y + 1) * kTile, frame.height);
  for (int v = tile_y * kTile; v < v_end; ++v) {
    for (int u = tile_x * kTile; u < u_end; ++u) {
      const float z = frame.depth(u, v);
      tile.nearest = std::min(tile.nearest, z > 0.0F ? z : 1e9F);
      tile.farthest = std::max(tile.farthest, z);
    }
  }
  for (int v = tile_y * kTile / 2; v < (v_end + 1) / 2; ++v) {
    for (int u = tile_x * kTile / 2; u < (u_end + 1) / 2; ++u) {
      tile.least_free = std::min(tile.least_free, frame.free_depth(u, v));
      tile.most_free = std::max(tile.most_free, frame.free_depth(u, v));
    }
  }
  return tile;
}

void summarise_tiles(FrameSurface& frame) {
  frame.tiles_x = (frame.width + FrameSurface::kTile - 1) / FrameSurface::kTile;
  frame.tiles_y = (frame.height + FrameSurface::kTile - 1) / FrameSurface::kTile;
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
  row.slope_tolerance = static_cast<float>(std::tan(kSteepestFit) * kPlaneReach / camera.fx);
  row.nearest = tables.nearest();
  row.steps_per_metre = tables.steps_per_metre();
  row.last_step = kNoiseDepths - 1;
  row.truncations = tables.truncations();
  row.inverse_tolerances = tables.inverse_tolerances();
  row.weights = tables.weights();
  return row;
}

/// Colours as the kernel wants them; black becomes the darkest blue, as 0 stands for none.
void pack_colors(std::span<const Rgb8> colors, std::vector<std::uint32_t>& packed) {
  for (std::size_t i = 0; i < colors.size(); ++i) {
    const auto [r, g, b] = colors[i];
    const std::uint32_t word = r | (std::uint32_t{g} << 8) | (std::uint32_t{b} << 16);
    packed[i] = word == 0 ? 0x010000U : word;
  }
}

}  // namespace

FrameSurface prepare_frame(const DepthImage& depth, const ColorImage& color,
                           const MaskImage& is_dynamic, const CameraModel& camera,
                           const NoiseTables& tables, Parallelism parallelism) {
  FrameSurface frame;
  frame.width = depth.width();
  frame.height = depth.height();
  frame.pixels.resize(depth.pixels().size() + 1);
  frame.pixels_used = count_used_readings(depth, is_dynamic, tables.noise(), frame.depth);
  frame.free_depth = find_free_depth(frame.depth, tables);
  summarise_tiles(frame);
  PaddedInverse inverse(frame.depth);
  const PixelRow first = row_template(camera, tables);
  parallel_for(parallelism, static_cast<std::size_t>(frame.height), kGrainRows,
               [&](std::size_t begin, std::size_t end) {
                 std::vector<std::uint32_t> colors(static_cast<std::size_t>(frame.width), 0U);
                 PixelRow row = first;
                 row.inverse_stride = inverse.stride;
                 for (int v = static_cast<int>(begin); v < static_cast<int>(end); ++v) {
                   row.inverse = inverse.row(v);
                   row.free_depth = frame.free_depth.row(v / 2).data();
                   row.ray_y = static_cast<float>((v - camera.cy) / camera.fy);
                   if (!color.empty()) pack_colors(color.row(v), colors);
                   row.color = colors.data();
                   kernels().find_surfaces(row, frame.pixels.data() + v * frame.width);
                 }
               });
  return frame;
}

}  // namespace pcavr
