// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/recordings/recording/import.hpp"
#include "pcavr/recordings/recording/recording_writer.hpp"

namespace pcavr {

/// Whether the folder has a file frame-*.color.*.
[[nodiscard]] bool has_seven_scenes_frames(const std::filesystem::path& source);

/// A sequence of 7-Scenes [Shotton et al. 2013]: frame-NUMBER.color.png (or .jpg), .depth.png in
/// millimetres and .pose.txt, a 4x4 matrix T_world_camera.
[[nodiscard]] Expected<ImportReport> import_seven_scenes(const std::filesystem::path& source,
                                                         const std::filesystem::path& target,
                                                         const ImportOptions& options,
                                                         const Observer& observer);

}  // namespace pcavr
