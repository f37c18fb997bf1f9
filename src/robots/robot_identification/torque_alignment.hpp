// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "pcavr/robots/robot/robot_model.hpp"
#include "pcavr/robots/robot_identification/joint_signals.hpp"
#include "pcavr/robots/robot_identification/log_checks.hpp"

namespace pcavr::detail {

/// Corrects the sign of all torques where they oppose those of the described bodies (a warning),
/// and finds torques of all joints, or of one, in another unit than these bodies' (an error). Where
/// no joint carries weight the unit does not show, which is a warning, too. `few`: some of the rows
/// of `signals`, whose torques' sign is corrected along.
void check_described_torques(const RobotModel& model, JointSignals& signals, JointSignals& few,
                             LogFindings& findings);

}  // namespace pcavr::detail
