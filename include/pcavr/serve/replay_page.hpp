// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/serve/content.hpp"

namespace pcavr {

/// Below a page's folder: the page into which a replay's files are written.
inline constexpr char kReplayPageFile[] = "replay/index.html";

struct ReplayPageOptions {
  std::size_t max_bytes = 8'000'000;  ///< of the file: what mail and issue trackers still accept
  bool replace = false;               ///< an existing file that is such a page
  bool skip_bad = false;              ///< leave out images that don't decode
};

/// What was written, and what of the scene and the images had room.
struct ReplayPage {
  std::size_t bytes = 0;
  std::size_t triangles = 0;        ///< of the scan's level of detail; 0: no scan
  std::size_t levels_left_out = 0;  ///< finer ones than that
  std::size_t images = 0;
  std::size_t images_recorded = 0;
};

/// Whether write_replay_page() could write there; for use before a long computation.
[[nodiscard]] Expected<void> check_replay_page(const std::filesystem::path& file, bool replace);

/// Writes a replay as one HTML file that opens without a server and makes no requests. `page`: the
/// built page, a kReplayPageFile. `scene`, `replay`: as a page gets them (SceneContent,
/// ReplayContent). `name`: the scene's, `version`: of pcavr. The scan's finest level that takes at
/// most half of the bytes is in it, then as many images, evenly spaced in time, as have room; cloud
/// and occupancy are not. An Error if the rest alone is larger than `max_bytes`, or a file can't be
/// read or written. Deterministic.
[[nodiscard]] Expected<ReplayPage> write_replay_page(
    const std::filesystem::path& file, const std::filesystem::path& page,
    const ContentSource& scene, const ContentSource& replay, const std::string& name,
    const std::string& version, const ReplayPageOptions& options = {});

}  // namespace pcavr
