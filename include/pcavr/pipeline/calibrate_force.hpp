// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/recordings/bag_import/pose_list.hpp"
#include "pcavr/robots/calibration/force_sensor.hpp"

namespace pcavr {

struct ForceInput {
  std::filesystem::path poses;   ///< a table of the flange's poses in base
  std::filesystem::path forces;  ///< a table of forces with stamps; empty: they are in `poses`
  PoseListOptions reading = {};
};

/// Poses at rest, and how the input was recognised.
struct ForceReadings {
  std::vector<ForceReading> readings = {};
  std::string format = {};
  std::vector<std::string> notes = {};  ///< for the user
};

/// Reads a table with a pose and a force in each row (read_pose_list, and fx, fy, fz, or force_x,
/// ..., with tx, ty, tz or torque_x, ...; units as in "fx [N]"), or two that are paired by stamps.
/// Of a log at 2 Hz and more the times at which the flange rests are averaged.
[[nodiscard]] Expected<ForceReadings> read_force_readings(const ForceInput& input);

/// The calibration file, in YAML.
[[nodiscard]] std::string format_force_sensor(const ForceSensorResult& found,
                                              const ForceInput& input);

/// Writes report.html and report.json, which has the same figures, to a folder.
[[nodiscard]] Expected<void> write_force_report(const ForceSensorResult& found,
                                                const ForceReadings& input,
                                                const std::string& report_json,
                                                const std::filesystem::path& folder);

}  // namespace pcavr
