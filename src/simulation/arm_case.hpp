// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include <Eigen/Core>

#include "pcavr/simulation/plant_arm.hpp"

namespace pcavr::simulation {

/// The description (URDF) of the six-axis arm of calib/robots/irb120_like with a stylus, whose
/// spherical end of `tip_radius` [m] is the link kArmTip.
[[nodiscard]] std::string arm_description(double tip_radius);
inline constexpr char kArmTip[] = "tip";

/// The arm of that description on the table of the simulated scenes, its tip at `p_base_start` [m]
/// and pointing down. The seed determines masses within 5 % and centres of mass within 5 mm of the
/// description's, rotor inertias, joint friction, gears, and how much of the friction the
/// controller knows.
[[nodiscard]] PlantArm make_arm(std::uint64_t seed, double tip_radius,
                                const Eigen::Vector3d& p_base_start);

}  // namespace pcavr::simulation
