// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "pcavr/base/core/parallel.hpp"
#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/perception/reconstruction/surface_tiles.hpp"

#include "perception/reconstruction/block_map.hpp"

namespace pcavr {

struct ExtractionParameters {
  double voxel_size = 0.0;  ///< [m]
  double min_weight = 1.0;  ///< [frames]
  int frames_to_clear = 3;
  /// [frames], of voxels that no frame observed as free; none: min_weight
  std::optional<double> min_uncontradicted_weight = {};
};

/// Marching cubes over all cubes whose eight corners are known. The order of vertices and triangles
/// does not depend on the number of threads.
[[nodiscard]] TriangleMesh extract_surface(const BlockMap& map,
                                           const ExtractionParameters& parameters,
                                           Parallelism parallelism);
/// The part of that surface which the blocks of a box own (empty: all). The map must have the
/// blocks next to the box too.
[[nodiscard]] SurfaceTile extract_tile(const BlockMap& map, const ExtractionParameters& parameters,
                                       const std::optional<BlockBox>& part,
                                       Parallelism parallelism);

}  // namespace pcavr
