// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/pipeline/task_graph.hpp"

#include "input_content.hpp"

namespace pcavr {

/// The file that states how a task ended, `pcavr-task/1` (JSON).
struct TaskRecord {
  std::string key;          ///< of the inputs, options and version; see key_of
  bool is_done = false;     ///< else it failed
  std::string reason = {};  ///< of the failure
  double seconds = 0.0;     ///< from start to end
  double cpu_seconds = 0.0;
  double memory = 0.0;                     ///< maximum resident size [bytes]
  std::vector<InputContent> outputs = {};  ///< of a done one, in the task's order
};

/// Files of a task in the results' folder, with the endings .json, .lock and .log.
[[nodiscard]] std::filesystem::path task_file(const TaskGraph& graph, const Task& task,
                                              const std::string& extension);

/// Empty where there is none, or none that can be read: the task is run again then.
[[nodiscard]] std::optional<TaskRecord> read_task_record(const std::filesystem::path& file);
[[nodiscard]] Expected<void> write_task_record(const TaskRecord& record,
                                               const std::filesystem::path& file);

/// SHA-256 of what a task's outputs depend on: version, command, the content of its recordings and
/// configuration, and `inputs`, the contents of the outputs of the tasks before it.
[[nodiscard]] std::string key_of(const TaskGraph& graph, const Task& task,
                                 const std::vector<std::string>& inputs);

/// Whether the record is that of a done task of this key whose outputs are unchanged.
[[nodiscard]] bool proves_done(const TaskRecord& record, const std::string& key, const Task& task);

/// One SHA-256 of all outputs.
[[nodiscard]] std::string content_of_outputs(const TaskRecord& record);

}  // namespace pcavr
