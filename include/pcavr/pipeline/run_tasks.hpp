// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/pipeline/task_graph.hpp"

namespace pcavr {

enum class TaskState {
  waiting,  ///< not done yet
  running,  ///< by a process of this machine, or of another on a shared file system
  done,
  failed,
  skipped,  ///< it needs a task that failed
};
[[nodiscard]] std::string_view name_of(TaskState state);

struct TaskStatus {
  TaskState state = TaskState::waiting;
  std::string reason = {};   ///< of failed and skipped ones, a line
  double seconds = 0.0;      ///< that it took; of done ones
  std::string content = {};  ///< SHA-256 of its outputs; of done ones
};

/// The state of each task, by the records in the results' folder: done is one whose record is of
/// the same inputs, options and version, and whose outputs are as it left them. Reads outputs only
/// where they were touched since. Writes nothing.
[[nodiscard]] Expected<std::vector<TaskStatus>> task_states(const TaskGraph& graph);

/// Time that the tasks that are not done need on one core [s]: by their estimates, scaled by what
/// the done ones took relative to theirs.
[[nodiscard]] double remaining_seconds(const TaskGraph& graph,
                                       const std::vector<TaskStatus>& states);

/// An Error where what the plan was made from has changed since (recordings, configurations), or
/// where the plan is of another version of pcavr. `only`: the inputs of this task alone.
[[nodiscard]] Expected<void> check_planned_inputs(const TaskGraph& graph,
                                                  std::optional<std::size_t> only = {});

struct RunTasksOptions {
  std::filesystem::path command;         ///< the program pcavr
  int jobs = 1;                          ///< tasks at a time, >= 1
  int threads = 1;                       ///< of each task, >= 1
  std::optional<std::size_t> only = {};  ///< this task alone; those that it needs must be done
};

struct TasksRun {
  std::vector<TaskStatus> states;  ///< by task
  std::size_t ran = 0;             ///< by this call
  std::size_t were_done = 0;       ///< before, or by another process meanwhile
};

/// Runs the tasks that are not done, each as a child process, whose output goes to the task's log.
/// A task that fails does not stop the others; those that need it are skipped. A task that another
/// process runs is waited for, and not done again. Children end with the calling thread.
[[nodiscard]] Expected<TasksRun> run_tasks(const TaskGraph& graph, const RunTasksOptions& options,
                                           const Observer& observer = {});

}  // namespace pcavr
