// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/pipeline/run_tasks.hpp"

namespace pcavr {

/// The status of a task that can't be run: skipped, since one that it needs failed, or waiting,
/// since one is not done. Empty where all that it needs is done. `states`: of the earlier tasks.
[[nodiscard]] std::optional<TaskStatus> blocked_status(const TaskGraph& graph, const Task& task,
                                                       const std::vector<TaskStatus>& states);

/// The key of a task whose earlier tasks are done.
[[nodiscard]] std::string key_of(const TaskGraph& graph, const Task& task,
                                 const std::vector<TaskStatus>& states);

/// What the record states of a task of this key: done or failed; else waiting.
[[nodiscard]] TaskStatus recorded_status(const TaskGraph& graph, const Task& task,
                                         const std::string& key);

/// The states of all tasks that this one needs; the others are left as waiting, so that a task of
/// many costs no look at the outputs of the others.
[[nodiscard]] std::vector<TaskStatus> states_before(const TaskGraph& graph, std::size_t index);

}  // namespace pcavr
