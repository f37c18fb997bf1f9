// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/pipeline/identify_robot.hpp"

namespace pcavr {

/// Where no weight shows the torques' scale, compares the inertia by the torques with the
/// description's: friction's stds contain the factor by which they differ, and a note says so. A
/// wrong unit of the torques, gain or clock of the log looks so; so does a motor's inertia.
void doubt_torque_scale(RobotIdentification& found);

}  // namespace pcavr
