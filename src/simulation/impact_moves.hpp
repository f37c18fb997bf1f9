// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/simulation/plant.hpp"

namespace pcavr::simulation {

class Program;  // tool_program.hpp

inline constexpr double kImpactSpeed = 0.2;  ///< [m/s] of the middle one of the impacts
/// [kg] of a light arm at its tip: peaks stay below 400 N, which force sensors of arms measure.
inline constexpr double kStrikerMass = 0.8;
/// Substeps per millisecond: an impact of 2 ms has 400.
inline constexpr int kImpactSubsteps = 200;

/// The tool with the effective mass of a striker.
[[nodiscard]] PlantTool striking_tool(const PlantTool& tool);

/// Sets contact stiffness and damping so that a free `mass` [kg] that arrives at `speed` [m/s]
/// bounces within `duration` [s] with this restitution. It uses the plant's own integration.
void set_impact(double speed, double mass, double duration, double restitution,
                PlantParameters& parameters);

/// Two slow presses along z, then five impacts from 0.7 to 1.4 of kImpactSpeed, on each of two
/// bodies.
void add_impact_moves(Program& program, double tip_radius);

}  // namespace pcavr::simulation
