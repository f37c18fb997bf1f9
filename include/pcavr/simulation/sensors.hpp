// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "pcavr/core/stamp.hpp"
#include "pcavr/geometry/trajectory.hpp"
#include "pcavr/recording/recording.hpp"
#include "pcavr/simulation/plant.hpp"

/// What an arm, its force sensor and a marker tracker would report of a PlantRun. Same seed, same
/// bits.
namespace pcavr {

/// What can be wrong with them, on top of noise.
struct SensorFaults {
  double clock_offset = 0.0;      ///< [s]: the wrench's stamps are late by that; negative: early
  bool is_force_flipped = false;  ///< force and torque with the wrong sign
  std::optional<double> saturation = {};  ///< [N]: no component of the force beyond
  /// The camera sees no object between these times.
  struct Gap {
    double begin = 0.0;  ///< [s]
    double end = 0.0;    ///< [s]
  };
  std::optional<Gap> lost_tracking = {};
};

/// At 500 Hz with 0.05 mm and 0.2 mrad of noise. The tool's z axis points down.
[[nodiscard]] Trajectory measured_tool(const PlantRun& run, std::uint64_t seed);

/// At 500 Hz, the mean over 2 ms stamped at its middle, with 0.2 N of noise (0.26 N along z), a
/// bias that wanders by 0.1 N, and now and then (1 in 1000) a spike of 6 to 35 N in one sample.
[[nodiscard]] std::vector<WrenchSample> measured_wrench(const PlantRun& run, std::uint64_t seed,
                                                        const SensorFaults& faults = {});

/// One frame's answer of a marker tracker.
struct SimulatedSighting {
  Stamp stamp;
  bool is_seen = false;
  Pose T_base_object;
  double position_sigma = 0.0;  ///< [m], all axes together
  double rotation_sigma = 0.0;  ///< [rad]
  bool is_at_rest = false;
};

/// At 30 Hz. While a body rests its pose is averaged and what is left is nearly constant, 0.05 to
/// 0.17 mm off; while it moves each frame is 0.3 mm and 0.07 degrees off by itself; one frame in
/// 50, in motion, up to 1 mm. As measured of our tracker on rendered recordings.
[[nodiscard]] std::vector<SimulatedSighting> simulated_tracking(const PlantRun& run,
                                                                const PlantBody& body,
                                                                std::size_t index,
                                                                std::uint64_t seed,
                                                                const SensorFaults& faults = {});

}  // namespace pcavr
