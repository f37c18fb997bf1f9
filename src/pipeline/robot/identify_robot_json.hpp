// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "pcavr/pipeline/identify_robot.hpp"

namespace pcavr {

/// report.json of `identify robot`: flat, SI. `log` and `robot`: the names of the inputs.
[[nodiscard]] std::string robot_report_json(const RobotIdentification& found,
                                            const std::string& log, const std::string& robot);

}  // namespace pcavr
