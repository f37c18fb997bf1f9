// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/robots/calibration/touched_points.hpp"

namespace pcavr {

/// Reads a table with a header: x, y, z of a point in the world, base_x, base_y, base_z of the tip
/// that touches it, and `name` where the points have names; lengths in m, or with a unit as in
/// x_mm. Errors name file and line.
[[nodiscard]] Expected<std::vector<TouchedPoint>> read_touched_points(
    const std::filesystem::path& file);

/// The calibration file, in YAML.
[[nodiscard]] std::string format_touch(const TouchResult& found, const std::filesystem::path& file);

/// Writes report.html and report.json, which has the same figures, to a folder.
[[nodiscard]] Expected<void> write_touch_report(const TouchResult& found,
                                                const std::string& report_json,
                                                const std::filesystem::path& folder);

}  // namespace pcavr
