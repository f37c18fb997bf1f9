// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/recordings/recording/joint_log.hpp"
#include "pcavr/robots/robot_identification/log_checks.hpp"

namespace pcavr::detail {

/// Units of stamps, positions and velocities that contradict each other, or that no arm has: adds
/// errors to `findings`. Every other check reads times and speeds, so this is the first. A log has
/// at least two rows.
void check_motion_units(const JointLog& log, LogFindings& findings);

}  // namespace pcavr::detail
