// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "pcavr/core/expected.hpp"
#include "pcavr/geometry/camera.hpp"
#include "pcavr/geometry/depth_noise.hpp"

namespace pcavr {

/// What a camera file tells of a sensor.
struct CameraFile {
  std::string name;
  CameraModel camera;
  std::optional<double> depth_scale = {};  ///< depth image units in one metre
  std::optional<DepthNoise> depth_noise = {};
};

/// Reads a camera file: pcavr's own keys (see calib/cameras), or ROS camera_info YAML with the
/// model plumb_bob, rational_polynomial or equidistant (its other keys are ignored). Refuses
/// intrinsics that no camera of that image has, and a lens that folds inside it. Errors name file,
/// line and key.
[[nodiscard]] Expected<CameraFile> read_camera_file(const std::filesystem::path& file);

}  // namespace pcavr
