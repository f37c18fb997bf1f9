// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/stamp.hpp"
#include "pcavr/simulation/plant_case.hpp"
#include "pcavr/simulation/sensors.hpp"

#include "simulation/camera_path.hpp"
#include "simulation/world.hpp"

namespace pcavr::simulation {

/// Ground truth, without sensor errors.
struct Truth {
  const World& world;
  const CameraPath& camera;
  const PlantCase& plant;
  const PlantRun& run;        ///< empty without a task
  std::vector<Stamp> frames;  ///< empty without images
};

/// Poses of all of the world's bodies at `t` [s]. Without a tool, all rest at their initial poses.
[[nodiscard]] std::vector<Pose> body_poses(const World& world, const PlantCase& plant,
                                           const PlantRun& run, double t);

/// Writes `truth/` in the recording format.
[[nodiscard]] Expected<void> write_truth(const std::filesystem::path& folder, const Truth& truth);

/// Writes tracked/objects/NAME/tracked.txt and tracking.csv in the format of a replay.
[[nodiscard]] Expected<void> write_tracking(const std::filesystem::path& folder, const Truth& truth,
                                            std::uint64_t seed, const SensorFaults& faults);

}  // namespace pcavr::simulation
