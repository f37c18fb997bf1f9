// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "pcavr/base/core/stamp.hpp"
#include "pcavr/base/geometry/trajectory.hpp"
#include "pcavr/recordings/recording/joint_log.hpp"
#include "pcavr/recordings/recording/recording.hpp"
#include "pcavr/simulation/plant.hpp"

/// Sensor models: the measurements of an arm, its force sensor and a marker tracker for a PlantRun.
/// Deterministic by seed.
namespace pcavr {

/// Sensor faults in addition to noise.
struct SensorFaults {
  double clock_offset = 0.0;              ///< [s]: added to the wrench's stamps
  bool is_force_flipped = false;          ///< force and torque with the wrong sign
  std::optional<double> saturation = {};  ///< [N]: limit of each force component
  /// Tracking loses all objects between these times.
  struct Gap {
    double begin = 0.0;  ///< [s]
    double end = 0.0;    ///< [s]
  };
  std::optional<Gap> lost_tracking = {};
  double tracking_delay = 0.0;  ///< [s]: added to the tracked poses' stamps
  /// [N/m]: the sensor's cable pulls the tool back towards where it started.
  double cable_stiffness = 0.0;
};

/// Adds the faults of a workshop, by seed: tracking 10 to 60 ms late, a cable of 0.5 to 2 N/m.
[[nodiscard]] SensorFaults with_workshop_faults(SensorFaults faults, std::uint64_t seed);

/// The tool's poses at 500 Hz with 0.05 mm and 0.2 mrad of noise. The tool's z axis points down.
[[nodiscard]] Trajectory measured_tool(const PlantRun& run, std::uint64_t seed);

/// The log of the plant's arm at 500 Hz, with noise of 10 urad, 1 mrad/s, and of 0.2 % of the
/// torque that the joint may have. Torques are the motors'.
[[nodiscard]] JointLog measured_joints(const PlantRun& run, const PlantArm& arm,
                                       std::uint64_t seed);

/// The tip that the arm's controller computes from the logged joints: the gears' deflection is not
/// in it.
[[nodiscard]] Trajectory measured_tool(const JointLog& log, const PlantArm& arm);

/// The forces at 500 Hz: the mean over 2 ms stamped at its middle, with 0.2 N of noise (0.26 N
/// along z), a bias that drifts by 0.1 N, and outliers (1 in 1000 samples) of 6 to 35 N.
[[nodiscard]] std::vector<WrenchSample> measured_wrench(const PlantRun& run, std::uint64_t seed,
                                                        const SensorFaults& faults = {});

/// The output of a marker tracker for one frame.
struct SimulatedMeasurement {
  Stamp stamp;
  bool is_seen = false;
  Pose T_base_object;
  double position_std = 0.0;  ///< [m], over all axes
  double rotation_std = 0.0;  ///< [rad]
  bool is_at_rest = false;
};

/// Measurements at 30 Hz. While a body rests its pose is averaged and the error is a nearly
/// constant bias of 0.05 to 0.17 mm; while it moves the errors of the frames are independent, 0.3
/// mm and 0.07 degrees, and up to 1 mm in one frame of 50. Our tracker has these errors on rendered
/// recordings.
[[nodiscard]] std::vector<SimulatedMeasurement> simulated_tracking(const PlantRun& run,
                                                                   const PlantBody& body,
                                                                   std::size_t index,
                                                                   std::uint64_t seed,
                                                                   const SensorFaults& faults = {});

}  // namespace pcavr
