// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

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
  std::string description;    ///< a line for --help
  bool is_camera_fixed = false;
  double duration = 4.0;      ///< [s]
  double frame_rate = 20.0;   ///< [Hz]
  int movable_boxes = 1;
  int clutter = 8;            ///< cylinders, spheres, boxes, prisms, cups
  bool with_moving_tool = false;  ///< a tool travels through the scene and pushes the boxes
  int width = 640;            ///< [px]
  int height = 480;
  DepthNoise depth_noise = {};
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
