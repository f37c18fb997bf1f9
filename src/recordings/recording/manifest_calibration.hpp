// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "pcavr/recordings/recording/manifest.hpp"
#include "pcavr/recordings/recording/yaml_map.hpp"

namespace pcavr {

/// The `format` of what `pcavr calibrate` writes.
inline constexpr char kCalibrationFormat[] = "pcavr-calibration/1";

/// Six rows of six numbers: the covariance of a twist [v (m); w (rad)]; fails where a variance is
/// negative.
[[nodiscard]] Matrix6d covariance_of(const YamlValue& value);

/// Takes what a calibration file found in the place of what the manifest states: of `calibrate
/// tags` the tags with their covariances, of `depth` scale and offset, of `objects` where tracked
/// bodies' meshes are, and their scales, of `force` how well its direction is known. Fails at `key`
/// where the file is of another kind, or can't be read.
void take_calibration(const std::filesystem::path& file, const YamlValue& key, Manifest& manifest);

}  // namespace pcavr
