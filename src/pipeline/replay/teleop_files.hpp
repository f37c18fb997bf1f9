// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include <yaml-cpp/emitter.h>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/pipeline/replay.hpp"

namespace pcavr {

/// predicted.txt of every object, force.csv, phases.csv, corrections.csv and parameters.yaml.
[[nodiscard]] Expected<void> write_teleop_files(const Replay& replay,
                                                const std::filesystem::path& folder);

/// Writes the run.yaml keys of a run of both sites, inside its map.
void emit_teleop(const Replay& replay, YAML::Emitter& yaml);

}  // namespace pcavr
