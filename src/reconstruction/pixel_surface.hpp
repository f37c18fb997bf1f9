// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "pcavr/core/parallel.hpp"
#include "pcavr/geometry/camera.hpp"
#include "pcavr/geometry/depth_noise.hpp"
#include "pcavr/geometry/image.hpp"

namespace pcavr {

/// What one pixel says about space, in camera axes; half a cache line, as the kernel gathers it.
struct alignas(32) PixelSurface {
  float normal[3] = {0.0F, 0.0F, 1.0F};  ///< of the plane through the surface, away from the camera
  float offset = -1e9F;      ///< plane: normal . p == offset [m]; far behind the camera: no surface
  float weight = 0.0F;       ///< units of VoxelBlock
  float truncation = 0.0F;   ///< [m]
  float free_depth = 0.0F;   ///< all that is nearer than this is free, for certain [m]
  std::uint32_t color = 0;   ///< red in the lowest byte; 0: none
};
static_assert(sizeof(PixelSurface) == 32);

struct FusionParameters {
  double voxel_size = 0.0;  ///< [m]
  double truncation = 0.0;  ///< least truncation [m]
  DepthNoise noise;
};

/// Ranges of depth over squares of kTile pixels, to tell what a block can meet.
struct DepthTile {
  float nearest = 1e9F;    ///< of the measured depths [m]
  float farthest = 0.0F;
  float least_free = 1e9F;  ///< of the free depths [m]
  float most_free = 0.0F;
};

/// A frame made ready for fusion.
struct FrameSurface {
  static constexpr int kTile = 8;  ///< [px]
  int width = 0;
  int height = 0;
  std::vector<PixelSurface> pixels;  ///< row-major, then one without a surface
  DepthImage depth;                  ///< used readings only
  int tiles_x = 0;
  int tiles_y = 0;
  std::vector<DepthTile> tiles;
  std::size_t pixels_used = 0;
};

/// Fits a plane to the inverse depth around each pixel (on a plane, inverse depth is linear in the
/// pixel), and from it the distance, incidence, weight and truncation. The camera has no
/// distortion. `is_dynamic` may be empty.
[[nodiscard]] FrameSurface prepare_frame(const DepthImage& depth, const ColorImage& color,
                                         const MaskImage& is_dynamic, const CameraModel& camera,
                                         const FusionParameters& parameters,
                                         Parallelism parallelism);

/// Truncation for a measurement at depth z: the noise must fit inside, with two voxels to spare
/// for the zero crossing.
[[nodiscard]] float truncation_at(const FusionParameters& parameters, float z);

}  // namespace pcavr
