// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/pipeline/task_graph.hpp"

namespace pcavr {

/// The file or folder as it is now, by its absolute path.
[[nodiscard]] Expected<PlannedInput> planned_input(const std::filesystem::path& path,
                                                   const std::string& without = {});

/// The recordings of a plan, read and hashed; see make_task_graph for errors. `support` as there.
[[nodiscard]] Expected<std::vector<PlannedRecording>> planned_recordings(
    const std::vector<std::string>& folders, const std::string& support, const Observer& observer);

}  // namespace pcavr
