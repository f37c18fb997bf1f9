// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "pcavr/core/parallel.hpp"
#include "pcavr/geometry/camera.hpp"
#include "pcavr/geometry/pose.hpp"

#include "reconstruction/block_map.hpp"
#include "reconstruction/frame_surface.hpp"

namespace pcavr {

/// Places of the blocks that the bands around a frame's surface pass through, each once, in an
/// order that depends on the frame alone.
[[nodiscard]] std::vector<BlockPlace> places_near_surface(const FrameSurface& frame,
                                                          const Pose& T_base_camera,
                                                          const NoiseTables& tables,
                                                          double voxel_size,
                                                          Parallelism parallelism);

/// A block that a frame has something to say about, and at which depths.
struct SeenBlock {
  std::uint32_t number = 0;
  bool wholly_free = false;   ///< the frame sees through all of it
  float band_nearest = 0.0F;  ///< see BlockView
  float band_farthest = 0.0F;
  float free_farthest = 0.0F;
};

/// The blocks in view, in the map's order of regions.
[[nodiscard]] std::vector<SeenBlock> seen_blocks(const BlockMap& map, const FrameSurface& frame,
                                                 const Pose& T_base_camera,
                                                 const NoiseTables& tables, double voxel_size);

}  // namespace pcavr
