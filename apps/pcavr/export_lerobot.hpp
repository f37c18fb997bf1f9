// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pcavr/pipeline/lerobot_dataset.hpp"

#include "commands.hpp"

namespace pcavr::app {

/// The `--to` of LeRobot data sets: of recordings, not of a scene.
inline constexpr char kLerobotFormat[] = "lerobot";

struct LerobotArguments {
  std::vector<std::string> recordings;
  std::string parameters;           ///< empty: identified from each recording alone
  std::vector<std::string> scenes;  ///< none, one for all recordings, or one for each
  std::string output;
  LerobotOptions options;
};

/// Writes the recordings as the episodes of a data set.
[[nodiscard]] Expected<CommandResult> export_lerobot(const LerobotArguments& arguments,
                                                     Configuration& configuration,
                                                     const Observer& observer);

}  // namespace pcavr::app
