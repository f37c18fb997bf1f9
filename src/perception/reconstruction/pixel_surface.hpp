// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace pcavr {

/// The local surface and free space of one pixel, in camera axes; half a cache line, as the kernel
/// gathers it.
struct alignas(32) PixelSurface {
  float normal[3] = {0.0F, 0.0F, 1.0F};  ///< of the plane through the surface, away from the camera
  float offset = -1e9F;     ///< plane: normal . p == offset [m]; far behind the camera: no surface
  float weight = 0.0F;      ///< units of VoxelBlock
  float truncation = 0.0F;  ///< [m]
  float free_depth = 0.0F;  ///< space up to this depth is certainly free [m]
  std::uint32_t color = 0;  ///< red in the lowest byte; 0: none
};
static_assert(sizeof(PixelSurface) == 32);

}  // namespace pcavr
