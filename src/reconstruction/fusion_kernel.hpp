// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "reconstruction/pixel_surface.hpp"
#include "reconstruction/voxel_block.hpp"

namespace pcavr {

/// One block seen by one frame. Plain numbers only: the kernel is compiled several times, for
/// several instruction sets, and must not share code with the rest of the program.
struct BlockView {
  const PixelSurface* pixels;
  int width;
  int height;
  float fx, fy, cx, cy;
  float origin[3];   ///< the block's lowest voxel in camera axes [m]
  float step_x[3];   ///< from voxel to voxel along the block's axes, in camera axes [m]
  float step_y[3];
  float step_z[3];
  float band_nearest;   ///< no surface's band begins nearer than this depth [m]
  float band_farthest;  ///< or ends farther
  float free_farthest;  ///< nothing farther than this is seen through [m]
  float steps_per_metre;
  float voxel_size;
  std::uint32_t dither;  ///< differs from frame to frame
};

using FusionKernel = void (*)(const BlockView& view, VoxelBlock& block);

/// The fastest kernel that this processor runs. All give the same bits.
[[nodiscard]] FusionKernel fusion_kernel();

/// Marks as seen through what lies nearer than the view's free depth, and nothing else.
void fuse_block_baseline(const BlockView& view, VoxelBlock& block);
void fuse_block_avx2(const BlockView& view, VoxelBlock& block);

}  // namespace pcavr
