// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/simulation/plant_case.hpp"

namespace pcavr {

/// Writes what a plant did into `folder`, as in the truth/ of a recording: the bodies' poses at
/// 100 Hz, their phases, impacts and parameters. Creates the folder.
[[nodiscard]] Expected<void> write_plant_truth(const std::filesystem::path& folder,
                                               const PlantCase& plant, const PlantRun& run);

}  // namespace pcavr
