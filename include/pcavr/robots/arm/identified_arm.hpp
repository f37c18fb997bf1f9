// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/robots/robot/robot_model.hpp"
#include "pcavr/robots/robot_identification/robot_fit.hpp"

namespace pcavr {

/// The findings of `pcavr identify robot` about an arm.
struct IdentifiedArm {
  RobotModel model;              ///< the identified joints, with their inertias; others are locked
  std::vector<JointFit> joints;  ///< friction, also as three parameters, by coordinate
};

/// Reads the report.json of `pcavr identify robot` (or of the folder that holds it) for an arm with
/// this description. Errors: a file that is missing, no such report or another robot's, bodies that
/// are not possible. Pure function but for the file.
[[nodiscard]] Expected<IdentifiedArm> read_identified_arm(
    const std::filesystem::path& file_or_folder, const RobotModel& described);

/// The same from the text of a report.json; `file` names it in errors.
[[nodiscard]] Expected<IdentifiedArm> parse_identified_arm(const std::string& text,
                                                           const std::filesystem::path& file,
                                                           const RobotModel& described);

}  // namespace pcavr
