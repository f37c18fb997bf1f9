// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

#include "pcavr/recording/camera_file.hpp"

#include "recording/yaml_map.hpp"

namespace pcavr {

/// Sides of JPEG files are 16 bits long [ITU-T T.81, B.2.2]; libjpeg stops at this [px].
inline constexpr int kLargestImageSide = 65500;

/// k1 k2 p1 p2 k3. Throws YamlFailure, as the next one.
[[nodiscard]] std::array<double, 5> distortion_of(const YamlValue& value);
/// The keys width, height, fx, fy, cx, cy and distortion, which may be absent. Does not look for
/// unknown keys.
[[nodiscard]] CameraModel camera_of(const YamlValue& value);

/// read_camera_file for a text; `file` names it in errors.
[[nodiscard]] Expected<CameraFile> parse_camera_file(const std::string& text,
                                                     const std::string& file);

}  // namespace pcavr
