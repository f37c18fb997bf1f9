// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/depth_noise.hpp"

namespace pcavr {

/// The name of a lens model, the value of the key `model` in recording.yaml and camera files.
[[nodiscard]] std::string_view name_of(LensModel model);

/// The content of a camera file.
struct CameraFile {
  std::string name;
  CameraModel camera;
  std::optional<double> depth_scale = {};  ///< depth image units in one metre
  std::optional<DepthNoise> depth_noise = {};
};

/// Reads a camera file: pcavr's own keys (see calib/cameras), or ROS camera_info YAML with the
/// model plumb_bob, rational_polynomial or equidistant (its other keys are ignored). Refuses
/// intrinsics that are impossible for the image size, and a lens model that folds (is not
/// one-to-one) inside the image. Errors name file, line and key.
[[nodiscard]] Expected<CameraFile> read_camera_file(const std::filesystem::path& file);

}  // namespace pcavr
