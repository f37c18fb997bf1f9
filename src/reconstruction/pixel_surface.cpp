// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "reconstruction/pixel_surface.hpp"

#include <algorithm>
#include <cmath>

#include "reconstruction/plane_fit.hpp"
#include "reconstruction/voxel_block.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kGrainRows = 16;


bool is_used(float z, const DepthNoise& noise) {
  return z >= static_cast<float>(noise.nearest) && z <= static_cast<float>(noise.farthest);
}

void keep_used_readings(const DepthImage& depth, const MaskImage& is_dynamic,
                        const DepthNoise& noise, FrameSurface& frame) {
  frame.depth = DepthImage(depth.width(), depth.height());
  const std::span<float> to = frame.depth.pixels();
  const std::span<const float> from = depth.pixels();
  std::size_t used = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const bool masked = !is_dynamic.empty() && is_dynamic.pixels()[i] != 0;
    to[i] = !masked && is_used(from[i], noise) ? from[i] : 0.0F;
    used += to[i] > 0.0F ? 1 : 0;
  }
  frame.pixels_used = used;
}

void fill_pixel(const InversePlane& plane, float z, Rgb8 color, const CameraModel& camera, int u,
                int v, const FusionParameters& parameters, PixelSurface& pixel) {
  const auto x = static_cast<float>((u - camera.cx) / camera.fx);
  const auto y = static_cast<float>((v - camera.cy) / camera.fy);
  // a x + b y + c = inverse depth, hence the plane a X + b Y + c Z = 1.
  const float a = plane.slope_u * static_cast<float>(camera.fx);
  const float b = plane.slope_v * static_cast<float>(camera.fy);
  const float c = plane.inverse_depth - a * x - b * y;
  const float scale = 1.0F / std::sqrt(a * a + b * b + c * c);
  pixel.normal[0] = a * scale;
  pixel.normal[1] = b * scale;
  pixel.normal[2] = c * scale;
  pixel.offset = scale;
  const float cosine = scale * plane.inverse_depth / std::sqrt(x * x + y * y + 1.0F);
  const float incidence = std::acos(std::clamp(cosine, 0.0F, 1.0F));
  const double best = parameters.noise.constant;
  const double sigma = parameters.noise.sigma(z, incidence);
  const double ratio = best / sigma;
  pixel.weight = std::max(1.0F, static_cast<float>(kWeightUnits * ratio * ratio));
  pixel.truncation = truncation_at(parameters, z);
  const auto packed = static_cast<std::uint32_t>(color.r | (color.g << 8) | (color.b << 16));
  pixel.color = std::max(packed, 1U);
}

// Nearer than what a pixel measured by its truncation and noise is free for certain, if that holds
// over the whole neighbourhood: pairs of pixels are pooled, then 3 x 3 of the pools. That guards
// two pixels to every side, about what 0.2 deg of pose error move an edge.
void find_free_depth(const FusionParameters& parameters, FrameSurface& frame) {
  const int half_width = (frame.width + 1) / 2;
  const int half_height = (frame.height + 1) / 2;
  DepthImage pooled(half_width, half_height, 1e9F);
  for (int v = 0; v < frame.height; ++v) {
    for (int u = 0; u < frame.width; ++u) {
      const float z = frame.depth(u, v);
      const float margin =
          truncation_at(parameters, z) + 3.0F * static_cast<float>(parameters.noise.sigma(z));
      float& pool = pooled(u / 2, v / 2);
      pool = std::min(pool, z > 0.0F ? std::max(0.0F, z - margin) : 0.0F);
    }
  }
  for (int v = 0; v < frame.height; ++v) {
    for (int u = 0; u < frame.width; ++u) {
      float least = 1e9F;
      for (int dv = -1; dv <= 1; ++dv) {
        for (int du = -1; du <= 1; ++du) {
          const int x = u / 2 + du;
          const int y = v / 2 + dv;
          least = std::min(least, pooled.contains(x, y) ? pooled(x, y) : 0.0F);
        }
      }
      frame.pixels[static_cast<std::size_t>(v * frame.width + u)].free_depth = least;
    }
  }
}

void summarise_tiles(FrameSurface& frame) {
  constexpr int kTile = FrameSurface::kTile;
  frame.tiles_x = (frame.width + kTile - 1) / kTile;
  frame.tiles_y = (frame.height + kTile - 1) / kTile;
  frame.tiles.assign(static_cast<std::size_t>(frame.tiles_x * frame.tiles_y), DepthTile{});
  for (int v = 0; v < frame.height; ++v) {
    for (int u = 0; u < frame.width; ++u) {
      DepthTile& tile =
          frame.tiles[static_cast<std::size_t>(v / kTile * frame.tiles_x + u / kTile)];
      const float z = frame.depth(u, v);
      const float free_depth = frame.pixels[static_cast<std::size_t>(v * frame.width + u)].free_depth;
      if (z > 0.0F) {
        tile.nearest = std::min(tile.nearest, z);
        tile.farthest = std::max(tile.farthest, z);
      }
      tile.least_free = std::min(tile.least_free, free_depth);
      tile.most_free = std::max(tile.most_free, free_depth);
    }
  }
}

}  // namespace

float truncation_at(const FusionParameters& parameters, float z) {
  const double noise = 3.0 * parameters.noise.sigma(z) + 2.0 * parameters.voxel_size;
  return static_cast<float>(std::max(parameters.truncation, noise));
}

FrameSurface prepare_frame(const DepthImage& depth, const ColorImage& color,
                           const MaskImage& is_dynamic, const CameraModel& camera,
                           const FusionParameters& parameters, Parallelism parallelism) {
  FrameSurface frame;
  frame.width = depth.width();
  frame.height = depth.height();
  frame.pixels.resize(depth.pixels().size() + 1);
  keep_used_readings(depth, is_dynamic, parameters.noise, frame);
  const InversePlaneFitter fitter(frame.depth, parameters.noise, camera);
  parallel_for(parallelism, static_cast<std::size_t>(frame.height), kGrainRows,
               [&](std::size_t begin, std::size_t end) {
                 std::vector<InversePlane> planes(static_cast<std::size_t>(frame.width));
                 for (int v = static_cast<int>(begin); v < static_cast<int>(end); ++v) {
                   fitter.fit_row(v, planes);
                   for (int u = 0; u < frame.width; ++u) {
                     if (frame.depth(u, v) <= 0.0F) continue;
                     fill_pixel(planes[static_cast<std::size_t>(u)], frame.depth(u, v),
                                color.empty() ? Rgb8{} : color(u, v), camera, u, v, parameters,
                                frame.pixels[static_cast<std::size_t>(v * frame.width + u)]);
                   }
                 }
               });
  find_free_depth(parameters, frame);
  summarise_tiles(frame);
  return frame;
}

}  // namespace pcavr
