// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "reconstruction/pixel_surface.hpp"
#include "reconstruction/voxel_block.hpp"

// The inner loops of fusion, compiled once for each instruction set and chosen when the program
// runs. They take plain numbers only, and share no code with the rest of the program.
namespace pcavr {

/// One row of pixels to be turned into surfaces.
struct PixelRow {
  const float* inverse;     ///< 1 / depth of the row's first pixel; 0: nothing [1/m]
  int inverse_stride;       ///< to the next row; there are kPlaneReach pixels around the image
  const float* free_depth;  ///< [m]
  const std::uint32_t* color;
  int width;
  float ray_y;     ///< of the row, on the plane z = 1
  float ray_x;     ///< of the first pixel
  float ray_step;  ///< from pixel to pixel: 1 / fx
  float fx, fy;
  float slope_tolerance;  ///< largest relative change of inverse depth within the window
  float nearest;          ///< of the tables' first entry [m]
  float steps_per_metre;  ///< of the tables
  int last_step;
  const float* truncations;
  const float* inverse_tolerances;
  const float* weights;
};
/// The plane fit takes in the pixels this near.
inline constexpr int kPlaneReach = 2;

/// One row of readings to be filtered.
struct FilterRow {
  const float* centre;  ///< depth of the row's first pixel; 0: nothing [m]
  int stride;           ///< to the next row; there is an empty pixel around the image, and
                        ///< kMaxLanes more after each row
  int width;
  float nearest;           ///< of the table's first entry [m]
  float steps_per_metre;   ///< of the table
  const float* max_steps;  ///< to a neighbour on the same surface, over depth [m]
};
/// Of any instruction set.
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
  float band_nearest;   ///< no surface's band begins nearer than this depth [m]
  float band_farthest;  ///< or ends farther
  float free_farthest;  ///< nothing farther than this is seen through [m]
  float steps_per_metre;
  float voxel_size;
  std::uint32_t dither;          ///< differs from frame to frame
  std::uint32_t through_enough;  ///< seen through so often, more is not counted
};

struct Kernels {
  /// Keeps the pixels that enough neighbours agree with; 0 for the others.
  void (*filter_row)(const FilterRow& row, float* filtered);
  /// Two by two pixels of two rows to one, `width` times: the least,
  void (*pool_nearest)(const float* top, const float* bottom, int width, float* to);
  /// or the mean where they are one surface, that of the nearest where not.
  void (*pool_depth)(const float* top, const float* bottom, int width, float* to);
  /// The mean colour of each two by two pixels, as in PixelSurface; black becomes the darkest red,
  /// as 0 stands for none.
  void (*pool_colors)(const std::uint8_t* top, const std::uint8_t* bottom, int width,
                      std::uint32_t* to);
  /// Fits a plane to the inverse depth around each pixel (on a plane, it is linear in the pixel),
  /// and from it the distance, incidence, weight and truncation. Writes `width` pixels.
  void (*find_surfaces)(const PixelRow& row, PixelSurface* pixels);
  /// Averages the frame's signed distance and colour into the block, and counts what it saw
  /// through. `next`: the block that will be fused next, or null; it is fetched from memory.
  void (*fuse_block)(const BlockView& view, VoxelBlock& block, const VoxelBlock* next);
};

/// The fastest that this processor runs. All give the same bits.
[[nodiscard]] const Kernels& kernels();

/// All that this processor runs, from the plainest to the fastest; for tests.
[[nodiscard]] std::vector<const Kernels*> runnable_kernels();

}  // namespace pcavr
