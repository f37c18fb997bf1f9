// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string_view>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/pipeline/build_limits.hpp"
#include "pcavr/pipeline/build_scene.hpp"
#include "pcavr/recordings/recording/recording.hpp"

namespace pcavr {

/// Every `count`-th tile of a scene, from the `number`-th on (0-based).
struct TilePart {
  std::size_t number = 0;
  std::size_t count = 1;
};

/// Writes the next bytes of a file.
using WriteContent = std::function<Expected<void>(std::string_view)>;

/// A build by tiles whose fusion is shared by several processes: survey_tiles() once, fuse_tiles()
/// for each part, and build_scene_within() with `BuildLimits::survey` and `fused`. The scene is to
/// the bit that of build_scene_within() with the same tiles alone. All steps need the same
/// recording, options and version, which is checked, and machines of one byte order.

/// The first step: places all frames, and finds and masks what moves in them; no later step does
/// that again. Writes the file for them. `limits` must have a tile_size. An Error for a recording
/// without depth images, and where build_scene_within() has one before it fuses.
[[nodiscard]] Expected<void> survey_tiles(const BuildLimits& limits, const Recording& recording,
                                          const BuildOptions& options, const WriteContent& write,
                                          const Observer& observer = {});

/// Fuses a part of the tiles of the file of survey_tiles(), with the memory of one tile, and writes
/// the file for the last step. An Error where the file is damaged, or of another recording, version
/// or options.
[[nodiscard]] Expected<void> fuse_tiles(const std::filesystem::path& survey_file,
                                        const TilePart& part, const Recording& recording,
                                        const BuildOptions& options, const WriteContent& write,
                                        const Observer& observer = {});

/// Whether a file was written by one of these steps, by how it begins.
[[nodiscard]] bool is_tile_file(const std::filesystem::path& file);

}  // namespace pcavr
