// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/perception/scene/scene.hpp"
#include "pcavr/pipeline/build_scene.hpp"
#include "pcavr/recordings/recording/recording.hpp"

namespace pcavr {

/// Edge of a tile that fits most rooms [m].
inline constexpr double kDefaultTile = 4.0;

/// What a build may take of the machine, and what other processes have done of it.
struct BuildLimits {
  /// The surface is fused by squares of this edge, seen from above, one after the other [m]: the
  /// same mesh in less memory. Empty: at once.
  std::optional<double> tile_size = {};
  /// The file of survey_tiles() (tile_steps.hpp), which has the tile_size, in the place of placing
  /// the frames; and the files of fuse_tiles(), all parts of the tiles, in the place of fusing
  /// them. Both or none: else a ContractError.
  std::filesystem::path survey = {};
  std::vector<std::filesystem::path> fused = {};
  double max_memory = 0.0;  ///< an estimate above it is an Error [bytes]; 0: no limit
};

/// As build_scene(), within limits.
[[nodiscard]] Expected<Scene> build_scene_within(const BuildLimits& limits,
                                                 const Recording& recording,
                                                 const BuildOptions& options,
                                                 const Observer& observer = {});

}  // namespace pcavr
