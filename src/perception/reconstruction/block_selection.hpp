// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "pcavr/base/core/parallel.hpp"
#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/pose.hpp"

#include "perception/reconstruction/block_map.hpp"
#include "perception/reconstruction/frame_surface.hpp"

namespace pcavr {

/// Coordinates of the blocks in the truncation band around a frame's surface, without duplicates,
/// in a deterministic order.
[[nodiscard]] std::vector<BlockCoordinates> blocks_near_surface(const FrameSurface& frame,
                                                                const Pose& T_base_camera,
                                                                const NoiseTables& tables,
                                                                double voxel_size,
                                                                Parallelism parallelism);

/// A block in a frame's view, and the depth ranges that affect it.
struct VisibleBlock {
  std::uint32_t number = 0;
  bool is_entirely_free = false;  ///< the frame observes all of it as free
  float min_band_depth = 0.0F;    ///< see BlockView
  float max_band_depth = 0.0F;
  float max_free_depth = 0.0F;
};

/// The blocks in view (frustum culling), in the map's order of regions.
[[nodiscard]] std::vector<VisibleBlock> visible_blocks(const BlockMap& map,
                                                       const FrameSurface& frame,
                                                       const Pose& T_base_camera,
                                                       const NoiseTables& tables,
                                                       double voxel_size);

}  // namespace pcavr
