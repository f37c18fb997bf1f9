// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <utility>

#include <fmt/core.h>

#include "pcavr/pipeline/run_tasks.hpp"

#include "task_lock.hpp"
#include "task_record.hpp"
#include "task_state.hpp"

namespace pcavr {
namespace {

constexpr std::array<std::string_view, 5> kStateNames{"waiting", "running", "done", "failed",
                                                      "skipped"};

Error changed(const PlannedInput& input) {
  return {.message = "has changed since the plan was made",
          .file = input.path.string(),
          .place = {},
          .hint = "make the plan again, with --force: what is done of other inputs stays done"};
}

Expected<void> check_input(const PlannedInput& input, const std::string& without = {}) {
  const Expected<bool> unchanged =
      is_unchanged({input.content, input.listing}, input.path, without);
  if (!unchanged) return unchanged.error();
  return *unchanged ? Expected<void>() : changed(input);
}

Expected<void> check_optional(const std::optional<PlannedInput>& input) {
  return input ? check_input(*input) : Expected<void>();
}

Expected<void> check_recording(const PlannedRecording& recording) {
  const Expected<void> files = check_input(recording.files, "truth");
  return files ? check_optional(recording.truth) : files;
}

/// By the states of the earlier tasks.
TaskStatus status_of(const TaskGraph& graph, const Task& task,
                     const std::vector<TaskStatus>& states) {
  std::optional<TaskStatus> status = blocked_status(graph, task, states);
  if (!status) status = recorded_status(graph, task, key_of(graph, task, states));
  if (status->state != TaskState::done && TaskLock::is_locked(task_file(graph, task, ".lock")))
    return {.state = TaskState::running};
  return *std::move(status);
}

}  // namespace

std::string_view name_of(TaskState state) {
  return kStateNames.at(static_cast<std::size_t>(state));
}

std::optional<TaskStatus> blocked_status(const TaskGraph& graph, const Task& task,
                                         const std::vector<TaskStatus>& states) {
  bool is_blocked = false;
  for (const std::size_t before : task.after) {
    const TaskState state = states[before].state;
    if (state == TaskState::failed || state == TaskState::skipped) {
      return TaskStatus{
          .state = TaskState::skipped,
          .reason = fmt::format("needs {}, which {}", graph.tasks[before].name,
                                state == TaskState::failed ? "failed" : "is skipped")};
    }
    is_blocked |= state != TaskState::done;
  }
  return is_blocked ? std::optional(TaskStatus()) : std::nullopt;
}

std::string key_of(const TaskGraph& graph, const Task& task,
                   const std::vector<TaskStatus>& states) {
  std::vector<std::string> inputs;
  for (const std::size_t before : task.after) inputs.push_back(states[before].content);
  return key_of(graph, task, inputs);
}

TaskStatus recorded_status(const TaskGraph& graph, const Task& task, const std::string& key) {
  const std::optional<TaskRecord> record = read_task_record(task_file(graph, task, ".json"));
  if (!record || record->key != key) return {};
  if (proves_done(*record, key, task)) {
    return {.state = TaskState::done,
            .seconds = record->seconds,
            .content = content_of_outputs(*record)};
  }
  if (record->is_done) return {};
  return {.state = TaskState::failed, .reason = record->reason};
}

std::vector<TaskStatus> states_before(const TaskGraph& graph, std::size_t index) {
  std::vector<bool> is_needed(graph.tasks.size(), false);
  for (const std::size_t before : graph.tasks[index].after) is_needed[before] = true;
  for (std::size_t i = index; i-- > 0;) {
    if (!is_needed[i]) continue;
    for (const std::size_t before : graph.tasks[i].after) is_needed[before] = true;
  }
  std::vector<TaskStatus> states(graph.tasks.size());
  for (std::size_t i = 0; i < index; ++i) {
    if (is_needed[i]) states[i] = status_of(graph, graph.tasks[i], states);
  }
  return states;
}

Expected<std::vector<TaskStatus>> task_states(const TaskGraph& graph) {
  std::vector<TaskStatus> states;
  for (const Task& task : graph.tasks) states.push_back(status_of(graph, task, states));
  return states;
}

double remaining_seconds(const TaskGraph& graph, const std::vector<TaskStatus>& states) {
  double estimated = 0.0;
  double taken = 0.0;
  double remaining = 0.0;
  for (std::size_t i = 0; i < states.size(); ++i) {
    const double estimate = graph.tasks[i].estimate.seconds;
    if (states[i].state == TaskState::done) {
      estimated += estimate;
      taken += states[i].seconds;
    } else if (states[i].state == TaskState::waiting || states[i].state == TaskState::running) {
      remaining += estimate;
    }
  }
  return estimated > 0.0 ? remaining * taken / estimated : remaining;
}

Expected<void> check_planned_inputs(const TaskGraph& graph, std::optional<std::size_t> only) {
  if (graph.version != PCAVR_VERSION) {
    return Error{.message = fmt::format("the plan is of pcavr {}, and this is {}", graph.version,
                                        PCAVR_VERSION),
                 .file = {},
                 .place = {},
                 .hint = "make the plan again, with --force"};
  }
  Expected<void> checked = check_optional(graph.configuration);
  for (const ReplaySetting& setting : graph.settings) {
    if (checked) checked = check_optional(setting.configuration);
  }
  if (!checked) return checked;
  for (std::size_t i = 0; i < graph.recordings.size(); ++i) {
    if (only && graph.tasks[*only].recordings.front() != i) continue;
    checked = check_recording(graph.recordings[i]);
    if (!checked) return checked;
  }
  return {};
}

}  // namespace pcavr
