// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "pcavr/base/report/report_page.hpp"
#include "pcavr/pipeline/identify_robot.hpp"

namespace pcavr {

/// A sentence that states how well the arm's torques are described.
[[nodiscard]] std::string robot_verdict(const RobotIdentification& found);
/// The main figures of all joints, the most important first.
[[nodiscard]] ReportTable robot_headline(const RobotIdentification& found);

}  // namespace pcavr
