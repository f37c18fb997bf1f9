// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/base/core/parallel.hpp"
#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/depth_noise.hpp"
#include "pcavr/simulation/plant_case.hpp"
#include "pcavr/simulation/sensors.hpp"

namespace pcavr {

/// A simulated recording: a table with clutter, tags and boxes in front of a wall, and optionally a
/// tool.
struct SimulationCase {
  std::string name;
  std::string description;  ///< one line for --help
  bool is_camera_fixed = false;
  ToolTask task = ToolTask::none;
  bool has_arm = false;   ///< a six-axis arm with its own dynamics does the task
  double duration = 4.0;  ///< [s]; with a task, that task's duration
  /// [s], for ToolTask::push only: boxes are pushed until then; 0: each once.
  double push_duration = 0.0;
  double frame_rate = 20.0;  ///< [Hz]
  /// At most PushOptions::kMaxBoxes. A task determines the number itself; push uses this one where
  /// it is above 0, else two. More than two are small and stand in a grid, seen from above.
  int movable_boxes = 1;
  int base_tags = 1;  ///< 0 to 2: on the table, and on the wall
  int clutter = 8;    ///< cylinders, spheres, boxes, prisms, cups
  int width = 640;    ///< [px]
  int height = 480;
  /// The camera, with its own image size; absent: a pinhole with the first Kinect's field of view
  /// (62 degrees).
  std::optional<CameraModel> camera = {};
  int depth_width = 0;  ///< [px], for depth images smaller than colour by one factor; 0: as colour
  int depth_height = 0;
  /// First Kinect; it measures nothing nearer than 0.4 m or farther than 4 m.
  DepthNoise depth_noise = DepthNoise(0.4, 4.0);
  double corner_blur = 0.55;  ///< of the colour image [px]
  /// Without images there are no camera and no markers either; the manifest states the objects'
  /// initial poses, and tracked/objects/NAME/ contains the output of a simulated marker tracker, in
  /// the format that a replay writes.
  bool with_images = true;
  bool with_mass = true;  ///< in the manifest
  /// The boxes are fixed to the table, with movable: false in the manifest; ToolTask::press only.
  bool is_immovable = false;
  SensorFaults faults = {};
  /// PlantVariety::wide, with_workshop_faults, and images that are exposed for 1/60 s, in which
  /// what moves is blurred.
  bool is_wide = false;
};

/// The camera of the case.
[[nodiscard]] CameraModel simulated_camera(const SimulationCase& simulation);

/// The cases of `pcavr simulate`.
[[nodiscard]] const std::vector<SimulationCase>& simulation_cases();

/// Writes a recording of the case with exact ground truth (`truth/`) to an existing folder. The
/// same seed gives the same bytes with any number of threads.
[[nodiscard]] Expected<void> simulate(const SimulationCase& simulation, std::uint64_t seed,
                                      const std::filesystem::path& folder, Parallelism parallelism,
                                      const Observer& observer = {});

}  // namespace pcavr
