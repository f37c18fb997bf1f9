// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/core/expected.hpp"
#include "pcavr/core/observer.hpp"
#include "pcavr/core/parallel.hpp"
#include "pcavr/geometry/camera.hpp"
#include "pcavr/geometry/depth_noise.hpp"
#include "pcavr/simulation/plant_case.hpp"
#include "pcavr/simulation/sensors.hpp"

namespace pcavr {

/// A made-up recording: a table with clutter, tags and boxes before a wall, and perhaps a tool.
struct SimulationCase {
  std::string name;
  std::string description;  ///< a line for --help
  bool is_camera_fixed = false;
  ToolTask task = ToolTask::none;
  double duration = 4.0;  ///< [s]; with a task, as long as that takes
  /// [s], of ToolTask::push alone: boxes are pushed until then; 0: each once.
  double push_duration = 0.0;
  double frame_rate = 20.0;  ///< [Hz]
  /// At most PushOptions::kMaxBoxes. With a task, those that it takes; push takes others than its
  /// two where this is above 0. More than two are small and stand in a grid, seen from above.
  int movable_boxes = 1;
  int base_tags = 1;  ///< 0 to 2: on the table, and on the wall
  int clutter = 8;    ///< cylinders, spheres, boxes, prisms, cups
  int width = 640;    ///< [px]
  int height = 480;
  /// With its own size; absent: a pinhole as wide as the first Kinect (62 degrees).
  std::optional<CameraModel> camera = {};
  int depth_width = 0;  ///< [px], of depth images smaller than colour by one factor; 0: as colour
  int depth_height = 0;
  /// First Kinect; it measures nothing nearer than 0.4 m or farther than 4 m.
  DepthNoise depth_noise = {.nearest = 0.4, .farthest = 4.0};
  double corner_blur = 0.55;  ///< of the colour image [px]
  /// Without images there is no camera and no markers either; the manifest says where the objects
  /// start, and tracked/objects/NAME/ holds what a marker tracker would have found, as a replay
  /// writes it.
  bool with_images = true;
  bool with_mass = true;  ///< in the manifest
  SensorFaults faults = {};
};

/// The camera that the case is seen through.
[[nodiscard]] CameraModel simulated_camera(const SimulationCase& simulation);

/// The cases that `pcavr simulate` knows.
[[nodiscard]] const std::vector<SimulationCase>& simulation_cases();

/// Makes a recording of the case with exact `truth/` in a folder that exists. The same seed gives
/// the same bytes at any number of threads.
[[nodiscard]] Expected<void> simulate(const SimulationCase& simulation, std::uint64_t seed,
                                      const std::filesystem::path& folder, Parallelism parallelism,
                                      const Observer& observer = {});

}  // namespace pcavr
