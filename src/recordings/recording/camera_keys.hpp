// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "pcavr/recordings/recording/camera_file.hpp"
#include "pcavr/recordings/recording/yaml_map.hpp"

namespace pcavr {

/// Sides of JPEG files are 16 bits long [ITU-T T.81, B.2.2]; libjpeg's own limit [px].
inline constexpr int kMaxImageSide = 65500;

enum class CameraKey { fx, fy, cx, cy, distortion };

struct CameraFault {
  CameraKey key = CameraKey::fx;
  std::string message;
  std::string hint;
};

/// Intrinsics that are impossible for the image size, or a lens that folds inside the image.
[[nodiscard]] std::optional<CameraFault> find_camera_fault(const CameraModel& camera);

/// The YAML nodes that a camera was read from, for the line in errors.
struct CameraKeys {
  YamlValue fx, fy, cx, cy;
  std::optional<YamlValue> distortion = {};
};

/// The model's coefficients, in the order of coefficient_names(). Throws YamlFailure, as the
/// functions below.
[[nodiscard]] LensDistortion distortion_of(const YamlValue& value, LensModel model);
/// Throws where the camera has a fault.
void check_camera(const CameraModel& camera, const CameraKeys& keys);
/// Reads and checks the keys width, height, fx, fy, cx, cy, and model and distortion, which may be
/// absent. Does not check for unknown keys.
[[nodiscard]] CameraModel camera_of(const YamlValue& value);

/// Does the same as read_camera_file, for a text; `file` names it in errors.
[[nodiscard]] Expected<CameraFile> parse_camera_file(const std::string& text,
                                                     const std::string& file);

}  // namespace pcavr
