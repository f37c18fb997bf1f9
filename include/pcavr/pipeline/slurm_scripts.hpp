// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/pipeline/task_graph.hpp"

namespace pcavr {

struct SlurmScript {
  std::string name;  ///< of its file
  std::string text;
};

inline constexpr char kSubmitScript[] = "submit.sh";

/// A job array for each stage and setting, whose elements are the recordings, and the script that
/// submits them with their dependencies (aftercorr), which is the last. Memory and time requested
/// are the estimates of the array's largest task with a margin. `plan` and `command` are absolute
/// paths on the nodes.
[[nodiscard]] std::vector<SlurmScript> slurm_scripts(const TaskGraph& graph,
                                                     const std::filesystem::path& plan,
                                                     const std::filesystem::path& command);

/// Writes the scripts into a folder, which is created, and submits them where this machine has
/// sbatch. Whether they were submitted.
[[nodiscard]] Expected<bool> submit_to_slurm(const std::vector<SlurmScript>& scripts,
                                             const std::filesystem::path& folder);

}  // namespace pcavr
