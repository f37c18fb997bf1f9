// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "pcavr/core/expected.hpp"
#include "pcavr/core/observer.hpp"
#include "pcavr/geometry/camera.hpp"

namespace pcavr {

enum class ImportFormat { tum_rgbd, seven_scenes };

struct ImportOptions {
  std::optional<ImportFormat> format = {};  ///< told from the folder's files where not given
  std::optional<CameraModel> camera = {};   ///< where the source has none (TUM RGB-D)
  std::optional<double> depth_scale = {};   ///< units in one metre; TUM 5000, 7-Scenes 1000
  double frame_rate = 30.0;                 ///< [Hz], for sources without stamps (7-Scenes)
  std::size_t stride = 1;                   ///< take every n-th frame
  std::size_t first = 0;                    ///< leave out the frames before this one
};

struct ImportReport {
  ImportFormat format = ImportFormat::tum_rgbd;
  std::size_t frames = 0;
  std::size_t poses = 0;
  std::size_t left_out = 0;  ///< frames without a partner or a pose file that could be read
};

/// Turns a TUM RGB-D or 7-Scenes folder into a recording at `target` (an existing, empty folder).
/// Their poses become `groundtruth.txt`. Invalid depth (7-Scenes: 65535) becomes 0.
[[nodiscard]] Expected<ImportReport> import_recording(const std::filesystem::path& source,
                                                      const std::filesystem::path& target,
                                                      const ImportOptions& options = {},
                                                      const Observer& observer = {});

}  // namespace pcavr
