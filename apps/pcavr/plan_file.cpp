// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "plan_file.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

namespace pcavr::app {

Expected<TaskGraph> read_valid_plan(const std::string& file, std::optional<std::size_t> only) {
  Expected<TaskGraph> graph = read_task_graph(file);
  if (!graph) return graph;
  if (only && *only >= graph->tasks.size()) {
    return Error{
        .message = fmt::format("has no task {}: they are 0 to {}", *only, graph->tasks.size() - 1),
        .file = file};
  }
  const Expected<void> checked = check_planned_inputs(*graph, only);
  if (!checked) return checked.error();
  return graph;
}

Expected<std::filesystem::path> own_command() {
  std::error_code code;
  std::filesystem::path command = std::filesystem::read_symlink("/proc/self/exe", code);
  if (!code) return command;
  return Error{.message = "this program's file can't be found: " + code.message(),
               .file = "/proc/self/exe"};
}

std::string duration_text(double seconds) {
  const auto whole = static_cast<long>(std::ceil(seconds));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
}

std::size_t count_of(const std::vector<TaskStatus>& states, TaskState state) {
  return static_cast<std::size_t>(std::ranges::count(states, state, &TaskStatus::state));
}

}  // namespace pcavr::app
