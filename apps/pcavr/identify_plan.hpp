// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "pcavr/base/core/output_file.hpp"
#include "pcavr/pipeline/plan_motion.hpp"
#include "pcavr/robots/robot_identification/exciting_motion.hpp"

#include "console.hpp"

namespace pcavr::app {

/// The file of `identify --plan`; with `replace`, an older plan is replaced.
[[nodiscard]] Expected<OutputFile> create_plan_file(const std::string& file, bool replace);

/// Appends the plan, which `file` contains, to the result of `identify`.
void add_plan(const MotionPlan& plan, const std::string& file, CommandResult& result);
/// Likewise, to that of `identify robot`; `fit` is what the plan was made from.
void add_plan(const ExcitingMotion& motion, const RobotFit& fit, const std::string& file,
              CommandResult& result);

}  // namespace pcavr::app
