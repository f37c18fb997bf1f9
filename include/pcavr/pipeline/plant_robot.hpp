// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/simulation/plant_case.hpp"
#include "pcavr/simulation/simulate.hpp"
#include "pcavr/teleoperation/sites/robot_interface.hpp"
#include "pcavr/teleoperation/teleop/run_teleop.hpp"

namespace pcavr {

/// A robot that knows what truly happened.
class PlantRobot : public RobotInterface {
 public:
  /// Keeps what happens. Call it before the first advance().
  virtual void keep_truth() = 0;
  /// Writes files as in the truth/ of a recording, in the scene's time: write_plant_truth.
  [[nodiscard]] virtual Expected<void> write_truth(const std::filesystem::path& folder) const = 0;
};

/// A simulated robot that follows commands: the plant of `pcavr simulate` for that task and seed in
/// real time, with its sensors and its tracker, whose poses arrive `tracking_latency` [s] after
/// their frames. Its boxes stand where `world` has the objects of the same names. An Error if an
/// object of one is not in the other. If it was not advanced for a while, as when the process was
/// stopped, the plant stood still meanwhile. With `camera`, of the same task, it has a camera.
[[nodiscard]] Expected<std::unique_ptr<PlantRobot>> make_plant_robot(
    ToolTask task, std::uint64_t seed, const TeleopInput& world, double tracking_latency,
    const SimulationCase* camera = nullptr);

}  // namespace pcavr
