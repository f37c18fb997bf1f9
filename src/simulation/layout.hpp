// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/simulation/plant.hpp"
#include "pcavr/simulation/simulate.hpp"

#include "simulation/world.hpp"

namespace pcavr::simulation {

/// The furniture of every case, in base [m]. The table's top is z = 0, as for a robot whose base
/// plate is mounted on it.
inline constexpr double kTableNear = 0.20;  ///< the table's edges
inline constexpr double kTableFar = 1.25;
inline constexpr double kTableSide = 0.70;
inline constexpr double kFloor = -0.72;
inline constexpr double kWall = -0.50;  ///< the wall behind the table: x of its surface

/// Builds the world: sizes, positions, colours and textures by seed. With a task the bodies are
/// those of its plant. Bodies do not overlap, and nothing stands where they will be pushed. Clutter
/// for which there is no room is omitted with a warning.
[[nodiscard]] Expected<World> make_world(const SimulationCase& simulation, const PlantCase& plant,
                                         std::uint64_t seed, const Observer& observer);

}  // namespace pcavr::simulation
