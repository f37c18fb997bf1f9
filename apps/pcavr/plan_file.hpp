// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/pipeline/run_tasks.hpp"

namespace pcavr::app {

inline constexpr int kMaxJobs = 1024;  ///< above the machines that pcavr was tested on

/// The plan, if its inputs are as they were; `only`: the inputs of this task alone.
[[nodiscard]] Expected<TaskGraph> read_valid_plan(const std::string& file,
                                                  std::optional<std::size_t> only = {});

/// This program's own file, for child processes.
[[nodiscard]] Expected<std::filesystem::path> own_command();

/// "3 min 20 s" of seconds, for people.
[[nodiscard]] std::string duration_text(double seconds);

/// The number of tasks in a state.
[[nodiscard]] std::size_t count_of(const std::vector<TaskStatus>& states, TaskState state);

}  // namespace pcavr::app
