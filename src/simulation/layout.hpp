// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "pcavr/core/expected.hpp"
#include "pcavr/core/observer.hpp"
#include "pcavr/simulation/plant.hpp"
#include "pcavr/simulation/simulate.hpp"

#include "simulation/world.hpp"

namespace pcavr::simulation {

/// The furniture of every case, all in base [m]. The table's top is z = 0, as where a robot's base
/// plate is screwed to it.
inline constexpr double kTableNear = 0.20;  ///< the table's edges
inline constexpr double kTableFar = 1.25;
inline constexpr double kTableSide = 0.70;
inline constexpr double kFloor = -0.72;
inline constexpr double kWall = -0.50;  ///< the wall behind the table: x of its surface

/// Sets the table: sizes, places, colours and textures by seed. With a task the bodies are those of
/// its plant. Bodies do not overlap, nor does anything stand where they will be pushed. Clutter
/// that finds no room is left out with a warning.
[[nodiscard]] Expected<World> make_world(const SimulationCase& simulation, const PlantCase& plant,
                                         std::uint64_t seed, const Observer& observer);

}  // namespace pcavr::simulation
