// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>

#include <Eigen/Core>

#include "pcavr/teleoperation/haptics/haptic_world.hpp"

namespace pcavr {

/// A place of the tool [m] from which a level motion pushes a body: beside the movable body that is
/// the nearest to the robot's base, at its mid-height, `clearance` [m] > 0 from it, with nothing
/// between the two. The side that faces the base comes first, then the sides next to it.
/// `is_guarded`: whether a guard encloses the tool at a place. nullopt without such a place.
[[nodiscard]] std::optional<Eigen::Vector3d> tool_start_beside_body(
    const HapticWorldModel& model, double clearance,
    const std::function<bool(const Eigen::Vector3d&)>& is_guarded);

}  // namespace pcavr
