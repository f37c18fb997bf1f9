// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "pcavr/results/export/export_robot.hpp"
#include "pcavr/robots/robot/urdf.hpp"

#include "support/two_joint_arm.hpp"

namespace pcavr {

inline Expected<ExportedRobot> two_joint_robot(const std::string& report = two_joint_report()) {
  const RobotModel described = parse_urdf(two_joint_urdf(), "two.urdf").value();
  const Expected<IdentifiedArm> arm = parse_identified_arm(report, "report.json", described);
  if (!arm) return arm.error();
  return make_exported_robot(described, *arm);
}

}  // namespace pcavr
