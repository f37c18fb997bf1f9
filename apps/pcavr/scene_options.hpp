// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/pipeline/build_limits.hpp"
#include "pcavr/pipeline/build_scene.hpp"

#include "configuration.hpp"

namespace pcavr::app {

/// Edge of a tile.
inline constexpr InputRange kTileRange{
    "edge of a tile", 0.5, 1000.0, "m",
    "from a table, below which borders cost more than they save, to any hall"};

/// The options of a build that its steps share when its tiles are fused apart.
struct SceneArguments {
  std::string recording;
  std::string sensor;
  bool trust_poses = false;
  double pose_std = 0.0;  ///< [m, rad]; 0: the configuration's
  bool skip_bad = false;
  double tile_size = 0.0;   ///< [m]; 0: none
  double max_memory = 0.0;  ///< [GB]; 0: the machine's
  int threads = 1;
};

void add_scene_options(CLI::App& command, SceneArguments& arguments, Configuration& configuration);
/// --tiles and --max-memory.
CLI::Option* add_limits(CLI::App& command, SceneArguments& arguments);

[[nodiscard]] Expected<BuildOptions> build_options_of(const SceneArguments& arguments,
                                                      const Configuration& configuration);
[[nodiscard]] BuildLimits limits_of(const SceneArguments& arguments);

}  // namespace pcavr::app
