// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "pcavr/pipeline/identify_robot.hpp"
#include "pcavr/report/report_page.hpp"

namespace pcavr {

/// How well the arm's torques are described, in a sentence.
[[nodiscard]] std::string robot_verdict(const RobotIdentification& found);
/// The main figures of all joints, the most important first.
[[nodiscard]] ReportTable robot_headline(const RobotIdentification& found);

}  // namespace pcavr
