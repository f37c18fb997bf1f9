// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/recordings/recording/import.hpp"

namespace pcavr {

/// The depth scale of an imported folder: the one that was given; without it, the camera file's or
/// that of the format. Where these two differ and the camera file states the sensor's range, the
/// format's is used if twice as many readings of some images are in that range under it. Images
/// that can't be decoded are not counted.
[[nodiscard]] ImportedDepthScale choose_depth_scale(
    const std::vector<std::filesystem::path>& depth_files, const CameraModel& camera,
    ImportFormat format, const ImportOptions& options);

}  // namespace pcavr
