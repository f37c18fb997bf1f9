// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "pcavr/pipeline/run_tasks.hpp"

#include "commands.hpp"
#include "plan_file.hpp"

namespace pcavr::app {
namespace {

CommandResult describe(const TaskGraph& graph, const std::vector<TaskStatus>& states) {
  CommandResult result;
  for (const TaskState state : {TaskState::done, TaskState::running, TaskState::failed,
                                TaskState::skipped, TaskState::waiting}) {
    const std::size_t count = count_of(states, state);
    result.summary += fmt::format("{:<8} {}\n", name_of(state), count);
    result.json[std::string(name_of(state))] = count;
  }
  result.json["tasks"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < states.size(); ++i) {
    const TaskStatus& status = states[i];
    result.json["tasks"].push_back({{"task", i},
                                    {"name", graph.tasks[i].name},
                                    {"state", name_of(status.state)},
                                    {"reason", status.reason}});
    if (status.state == TaskState::running)
      result.summary += fmt::format("  {} {} is running\n", i, graph.tasks[i].name);
    if (!status.reason.empty())
      result.summary += fmt::format("  {} {} {}: {}\n", i, graph.tasks[i].name,
                                    name_of(status.state), status.reason);
  }
  const double remaining = remaining_seconds(graph, states);
  result.summary += fmt::format("remaining: some {} on one core\n", duration_text(remaining));
  result.json["remaining_seconds"] = remaining;
  return result;
}

Expected<CommandResult> status_of(const std::string& plan) {
  const Expected<TaskGraph> graph = read_valid_plan(plan);
  if (!graph) return graph.error();
  const Expected<std::vector<TaskStatus>> states = task_states(*graph);
  if (!states) return states.error();
  return describe(*graph, *states);
}

}  // namespace

void add_status(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "status", "What is done of a plan, what runs, what failed and why, and what remains");
  command->footer("Example:\n  pcavr status pushes.json");
  auto plan = std::make_shared<std::string>();
  command->add_option("plan", *plan, "Plan from pcavr plan")->required();
  command->callback(
      [plan, &action] { action = [plan](const Observer&) { return status_of(*plan); }; });
}

}  // namespace pcavr::app
