// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/pipeline/identify_robot.hpp"

namespace pcavr {

/// Where much of a joint's torque is not explained, which may be friction or hide it: the stds of
/// its friction contain a force of that size, and a note says so. Torques that are out of step with
/// the positions look so.
void doubt_unexplained_torque(RobotIdentification& found);

}  // namespace pcavr
