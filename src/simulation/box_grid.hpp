// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "pcavr/base/core/random.hpp"
#include "pcavr/base/geometry/pose.hpp"

/// The layout of more than two movable boxes: small ones in a grid of four columns along base y.
/// Each has room to be pushed along its y by some centimetres and back, with the tip on either
/// side.
namespace pcavr::simulation {

/// Up to two boxes stand apart; more stand in the grid.
[[nodiscard]] inline bool needs_grid(int boxes) { return boxes > 2; }

/// [m]
[[nodiscard]] Eigen::Vector3d grid_half_extents(Random& random);

/// The pose of box `number` (from 0) of `count`, upright on the table, rotated by a few degrees at
/// most.
[[nodiscard]] Pose grid_pose(int number, int count, double half_height, Random& random);

/// Range of push distances in the grid [m].
inline constexpr double kMinGridPush = 0.015;
inline constexpr double kMaxGridPush = 0.03;

}  // namespace pcavr::simulation
