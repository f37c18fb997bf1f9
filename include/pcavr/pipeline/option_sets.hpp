// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/physics/identification/estimator.hpp"
#include "pcavr/physics/identification/motion_plan.hpp"
#include "pcavr/physics/object_identification/object_identification.hpp"
#include "pcavr/teleoperation/teleop/options.hpp"

namespace pcavr {

/// Options of `replay`: the segmentation is that of online identification.
[[nodiscard]] TeleopOptions replay_options(const TeleopOptions& teleop);

/// Options of `identify`: the sections that the robot's site uses to identify online.
[[nodiscard]] IdentificationOptions identification_options(const TeleopOptions& teleop,
                                                           const PlanOptions& plan,
                                                           const EstimatorOptions<3>& estimator);

}  // namespace pcavr
