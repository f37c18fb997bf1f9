// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pcavr/core/expected.hpp"
#include "pcavr/core/observer.hpp"
#include "pcavr/core/parallel.hpp"
#include "pcavr/geometry/depth_noise.hpp"

namespace pcavr {

/// A made-up recording: a table with clutter, tags and boxes before a wall.
struct SimulationCase {
  std::string name;
  std::string description;  ///< a line for --help
  bool is_camera_fixed = false;
  double duration = 4.0;          ///< [s]; with a tool, at least 3 s a box
  double frame_rate = 20.0;       ///< [Hz]
  int movable_boxes = 1;          ///< with a tool: 1 or 2
  int base_tags = 1;              ///< 0 to 2: on the table, and on the wall
  int clutter = 8;                ///< cylinders, spheres, boxes, prisms, cups
  bool with_moving_tool = false;  ///< a tool travels through the scene and pushes the boxes
  int width = 640;                ///< [px]
  int height = 480;
  std::array<double, 5> distortion{};  ///< k1 k2 p1 p2 k3 of the lens
  /// First Kinect; it measures nothing nearer than 0.4 m or farther than 4 m.
  DepthNoise depth_noise = {.nearest = 0.4, .farthest = 4.0};
  double corner_blur = 0.55;  ///< of the colour image [px]
};

/// The cases that `pcavr simulate` knows.
[[nodiscard]] const std::vector<SimulationCase>& simulation_cases();

/// Ray-casts the case into a recording with exact `truth/` in a folder that exists. The same seed
/// gives the same bytes at any number of threads.
[[nodiscard]] Expected<void> simulate(const SimulationCase& simulation, std::uint64_t seed,
                                      const std::filesystem::path& folder, Parallelism parallelism,
                                      const Observer& observer = {});

}  // namespace pcavr
