// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "commands.hpp"

namespace pcavr::app {

/// The `--to` of a planning scene, which has neither friction nor motion.
inline constexpr char kPlanningFormat[] = "moveit";

/// What is exported of a scene, an identified arm or both. Empty text: not given.
struct ExportArguments {
  std::string scene;
  std::string parameters;
  std::string motion;
  std::string format;
  std::string robot;
  std::string identified;
  std::string output;
  std::optional<double> speed;
  std::optional<double> tool_radius;
  bool assumes = false;
  std::size_t samples = 0;
  std::uint64_t seed = 1;
};

/// The formats of worlds for engines and planners.
[[nodiscard]] std::vector<std::string> world_formats();

/// Writes the arm alone, the scene's geometry or its world, whichever the arguments ask for.
[[nodiscard]] Expected<CommandResult> export_scene(const ExportArguments& arguments,
                                                   const Configuration& configuration,
                                                   const Observer& observer);

}  // namespace pcavr::app
