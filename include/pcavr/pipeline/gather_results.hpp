// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/pipeline/run_tasks.hpp"
#include "pcavr/pipeline/task_graph.hpp"
#include "pcavr/results/evaluation/compare_runs.hpp"

namespace pcavr {

struct GatheredResults {
  RunComparison comparison;  ///< of all evaluated runs; `objects` have a parameter file
  std::size_t atlas_rows = 0;
};

/// Collects what the tasks of a plan have made so far into a folder that exists: the table of
/// evaluations (write_run_comparison), parameters/NAME.yaml of each object, from all recordings
/// whose identification is done, and friction_atlas.csv and .parquet, a row for each object,
/// support and number. Where there are several recordings they are pooled as by `pcavr identify
/// friction REC REC ...`, in child processes that are kept as the plan's are: what is pooled
/// already is not pooled again. Warnings name what can't be pooled, and how many tasks are not
/// done; an Error where none is. `options.only` is ignored.
[[nodiscard]] Expected<GatheredResults> gather_results(const TaskGraph& graph,
                                                       const RunTasksOptions& options,
                                                       const std::filesystem::path& folder,
                                                       const Observer& observer = {});

}  // namespace pcavr
