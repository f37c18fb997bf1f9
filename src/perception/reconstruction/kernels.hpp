// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "perception/reconstruction/pixel_surface.hpp"
#include "perception/reconstruction/voxel_block.hpp"

// The inner loops of fusion, compiled for each instruction set and selected at run time (SIMD
// dispatch). They take plain numbers only, and share no code with the rest of the program.
namespace pcavr {

/// One row of pixels, input of find_surfaces.
struct PixelRow {
  const float* inverse;     ///< 1 / depth of the row's first pixel; 0: invalid [1/m]
  int inverse_stride;       ///< to the next row; the image is padded by kPlaneWindowRadius pixels
  const float* free_depth;  ///< [m]
  const std::uint32_t* color;
  int width;
  float ray_y;     ///< of the row, on the plane z = 1
  float ray_x;     ///< of the first pixel
  float ray_step;  ///< from pixel to pixel: 1 / fx
  float fx, fy;
  float slope_tolerance;  ///< maximum relative change of inverse depth within the window
  float min_depth;        ///< of the tables' first entry [m]
  float steps_per_metre;  ///< of the tables
  int last_step;
  const float* truncations;
  const float* inverse_tolerances;
  const float* weights;
};
/// Radius of the plane fit's window [px].
inline constexpr int kPlaneWindowRadius = 2;

/// One row of depth, input of filter_row.
struct FilterRow {
  const float* centre;  ///< depth of the row's first pixel; 0: invalid [m]
  int stride;           ///< to the next row; the image is padded by one empty pixel, and by
                        ///< kMaxLanes more after each row
  int width;
  float min_depth;         ///< of the table's first entry [m]
  float steps_per_metre;   ///< of the table
  const float* max_steps;  ///< to a neighbour on the same surface, by depth [m]
};
/// Maximum over all instruction sets.
inline constexpr int kMaxLanes = 16;

/// One block seen by one frame.
struct BlockView {
  const PixelSurface* pixels;
  int width;
  int height;
  float fx, fy, cx, cy;
  float origin[3];  ///< the block's lowest voxel in camera axes [m]
  float step_x[3];  ///< from voxel to voxel along the block's axes, in camera axes [m]
  float step_y[3];
  float step_z[3];
  float min_band_depth;  ///< depth where the first truncation band begins [m]
  float max_band_depth;  ///< depth where the last one ends [m]
  float max_free_depth;  ///< maximum depth observed as free [m]
  float steps_per_metre;
  float voxel_size;
  std::uint32_t dither;          ///< differs from frame to frame
  std::uint32_t max_free_count;  ///< free counts saturate at this
};

struct Kernels {
  /// Keeps the pixels with enough consistent neighbours; 0 for the others.
  void (*filter_row)(const FilterRow& row, float* filtered);
  /// Pools 2x2 pixels of two rows to `width` pixels: the minimum,
  void (*pool_min)(const float* top, const float* bottom, int width, float* to);
  /// or the mean; at a discontinuity the mean of the nearest surface.
  void (*pool_depth)(const float* top, const float* bottom, int width, float* to);
  /// The mean colour of each 2x2 pixels, as in PixelSurface; black becomes the darkest red, as 0
  /// means no colour.
  void (*pool_colors)(const std::uint8_t* top, const std::uint8_t* bottom, int width,
                      std::uint32_t* to);
  /// Fits a plane to the inverse depth around each pixel (on a plane, it is linear in the pixel),
  /// and from it the distance, incidence, weight and truncation. Writes `width` pixels.
  void (*find_surfaces)(const PixelRow& row, PixelSurface* pixels);
  /// Averages the frame's signed distance and colour into the block, and counts free voxels.
  /// `next`: the block that will be fused next, or null; it is prefetched.
  void (*fuse_block)(const BlockView& view, VoxelBlock& block, const VoxelBlock* next);
};

/// The fastest that this processor supports. All give bitwise identical results.
[[nodiscard]] const Kernels& kernels();

/// All that this processor supports, from the baseline to the fastest; for tests.
[[nodiscard]] std::vector<const Kernels*> supported_kernels();

}  // namespace pcavr
