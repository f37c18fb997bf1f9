// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "pcavr/base/core/parallel.hpp"
#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/image.hpp"

#include "perception/reconstruction/noise_tables.hpp"
#include "perception/reconstruction/pixel_surface.hpp"

namespace pcavr {

/// Depth ranges over a square of pixels, for culling blocks.
struct DepthTile {
  float min_depth = 1e9F;  ///< of the measured depths [m]
  float max_depth = 0.0F;
  float min_free = 1e9F;  ///< of the free depths [m]
  float max_free = 0.0F;
};

/// A frame prepared for fusion, at half the camera's resolution: the planes interpolate the surface
/// between pixels, so that only the last pixel at edges is lost.
struct FrameSurface {
  static constexpr int kTile = 4;    ///< [px]
  CameraModel camera;                ///< of the halved image
  std::vector<PixelSurface> pixels;  ///< row-major, followed by one without a surface
  DepthImage depth;                  ///< 0 outside the range and where dynamic [m]
  /// Space up to this depth is certainly free [m].
  DepthImage free_depth;
  int tiles_x = 0;
  int tiles_y = 0;
  std::vector<DepthTile> tiles;
  std::size_t pixels_used = 0;  ///< of the full image

  [[nodiscard]] std::size_t memory_bytes() const {
    return pixels.capacity() * sizeof(PixelSurface) + tiles.capacity() * sizeof(DepthTile) +
           (depth.pixels().size() + free_depth.pixels().size()) * sizeof(float);
  }
};

/// The camera has no distortion. `color` and `is_dynamic` may be empty. Overwrites `frame`, reusing
/// its memory.
void prepare_frame(const DepthImage& depth, const ColorImage& color, const MaskImage& is_dynamic,
                   const CameraModel& camera, const NoiseTables& tables, Parallelism parallelism,
                   FrameSurface& frame);

}  // namespace pcavr
