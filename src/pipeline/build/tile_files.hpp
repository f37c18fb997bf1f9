// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "pcavr/base/core/expected.hpp"

#include "tile_fusion.hpp"

namespace pcavr {

/// The files between the steps of a build by tiles: numbers as this machine has them, and the
/// SHA-256 of all before it at the end. What is read is to the bit what was written.

/// With the options of the build, of which the tiles are to be fused.
[[nodiscard]] std::string format_tile_frames(const TileFrames& frames, const BuildOptions& options);
/// An Error where the file is none, is damaged, or is of other options.
[[nodiscard]] Expected<TileFrames> read_tile_frames(const std::filesystem::path& file,
                                                    const BuildOptions& options);

/// The SHA-256 that a file's content ends with.
[[nodiscard]] std::string digest_of(std::string_view content);

/// `frames` is the digest of the file of frames.
[[nodiscard]] std::string format_fused_part(const FusedTiles& fused, const TilePart& part,
                                            const std::string& frames);
/// All parts of one scene, in any order. An Error where one is missing, is there twice, is damaged,
/// or was fused from other frames.
[[nodiscard]] Expected<FusedTiles> read_fused_parts(const std::vector<std::filesystem::path>& files,
                                                    const std::string& frames);

}  // namespace pcavr
