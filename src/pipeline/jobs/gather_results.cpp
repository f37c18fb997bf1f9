// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/gather_results.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

#include <fmt/core.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/physics/object/parameters_file.hpp"

#include "friction_atlas.hpp"
#include "task_estimates.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

/// Folder of the pooled identifications, in the results' folder; no support has this name.
constexpr char kPooled[] = "_pooled";

/// Recordings that are identified together, and the parameter file of them.
struct Pool {
  std::string support;  ///< empty: all recordings
  std::vector<std::size_t> recordings = {};
  fs::path parameters = {};
  fs::path report = {};                  ///< of several recordings
  std::optional<std::size_t> task = {};  ///< in the pools' graph; none for a single recording
  bool is_done = true;
};

/// The recordings whose friction is identified, with their parameter files.
std::map<std::size_t, fs::path> identified(const TaskGraph& graph,
                                           const std::vector<TaskStatus>& states) {
  std::map<std::size_t, fs::path> files;
  for (std::size_t i = 0; i < graph.tasks.size(); ++i) {
    const Task& task = graph.tasks[i];
    if (task.stage == TaskStage::identify && states[i].state == TaskState::done)
      files[task.recordings.front()] = task.outputs.front();
  }
  return files;
}

/// The scenes that the plan builds, by recording.
std::map<std::size_t, fs::path> planned_scenes(const TaskGraph& graph) {
  std::map<std::size_t, fs::path> scenes;
  for (const Task& task : graph.tasks) {
    if (task.stage == TaskStage::build) scenes[task.recordings.front()] = task.outputs.front();
  }
  return scenes;
}

Task pool_task(const TaskGraph& graph, const Pool& pool) {
  const std::string name = pool.support.empty() ? "all" : "support-" + pool.support;
  Task task{.name = std::string(kPooled) + '/' + name,
            .stage = TaskStage::pool,
            .recordings = pool.recordings};
  task.outputs = {graph.results / (task.name + ".yaml"), graph.results / (task.name + ".report")};
  task.command = {"identify", "friction"};
  const std::map<std::size_t, fs::path> scenes = planned_scenes(graph);
  std::size_t frames = 0;
  std::size_t samples = 0;
  for (const std::size_t one : pool.recordings) {
    task.command.push_back(graph.recordings[one].files.path.string());
    frames += graph.recordings[one].frames;
    samples += graph.recordings[one].samples;
  }
  // Each recording's own: where it has images, its objects' poses are in no other file.
  for (const std::size_t one : pool.recordings) {
    if (const auto scene = scenes.find(one); scene != scenes.end())
      task.command.insert(task.command.end(), {"--scene", scene->second.string()});
  }
  task.command.insert(task.command.end(),
                      {"-o", task.outputs[0].string(), "--report", task.outputs[1].string()});
  if (graph.configuration)
    task.command.insert(task.command.end(), {"--config", graph.configuration->path.string()});
  task.estimate = estimate_task(TaskStage::pool, frames, samples);
  return task;
}

/// One for each support; and one for all, where there are several.
std::vector<Pool> pools_of(const TaskGraph& graph, const std::map<std::size_t, fs::path>& files) {
  std::map<std::string, Pool> by_support;
  Pool all;
  for (const auto& [recording, file] : files) {
    const std::string& support = graph.recordings[recording].support;
    Pool& pool = by_support[support];
    pool.support = support;
    pool.recordings.push_back(recording);
    pool.parameters = file;
    all.recordings.push_back(recording);
  }
  std::vector<Pool> pools;
  for (auto& [support, pool] : by_support) pools.push_back(std::move(pool));
  if (pools.size() > 1) pools.push_back(std::move(all));
  return pools;
}

Expected<void> run_pools(const TaskGraph& graph, RunTasksOptions options, std::vector<Pool>& pools,
                         const Observer& observer) {
  TaskGraph pooled = graph;
  pooled.tasks.clear();
  for (Pool& pool : pools) {
    if (pool.recordings.size() < 2) continue;
    pool.task = pooled.tasks.size();
    pooled.tasks.push_back(pool_task(graph, pool));
    pool.parameters = pooled.tasks.back().outputs.front();
    pool.report = pooled.tasks.back().outputs.back();
  }
  options.only.reset();
  const Expected<TasksRun> run = run_tasks(pooled, options, observer);
  if (!run) return run.error();
  for (Pool& pool : pools)
    pool.is_done = !pool.task || run->states[*pool.task].state == TaskState::done;
  return {};
}

Expected<void> write_object_files(const ParameterTable& parameters, std::size_t recordings,
                                  const fs::path& folder, GatheredResults& gathered) {
  std::error_code code;
  fs::create_directories(folder / "parameters", code);
  if (code) {
    return Error{.message = "can't be created: " + code.message(),
                 .file = (folder / "parameters").string()};
  }
  for (const auto& [name, values] : parameters) {
    const Expected<void> written =
        write_file(folder / "parameters" / (name + ".yaml"),
                   format_parameters({{name, values}},
                                     fmt::format("identified from {} recordings", recordings)));
    if (!written) return written;
    gathered.comparison.objects.push_back(name);
  }
  return {};
}

/// The pools come in the order of pools_of: the last one has all recordings.
Expected<void> write_parameters(const std::vector<Pool>& pools, const fs::path& folder,
                                GatheredResults& gathered) {
  std::vector<AtlasRow> atlas;
  for (const Pool& pool : pools) {
    if (!pool.is_done) continue;
    const Expected<ParameterTable> parameters = read_parameters(pool.parameters);
    if (!parameters) return parameters.error();
    if (&pool == &pools.back()) {
      const Expected<void> written =
          write_object_files(*parameters, pool.recordings.size(), folder, gathered);
      if (!written) return written;
    }
    if (pool.support.empty()) continue;
    std::map<std::string, SurfaceStd> surface_stds;
    if (pool.task) {
      Expected<std::map<std::string, SurfaceStd>> read =
          read_surface_stds(pool.report / "report.json");
      if (!read) return read.error();
      surface_stds = *std::move(read);
    }
    for (const auto& [name, values] : *parameters) {
      std::ranges::move(
          atlas_rows_of(name, pool.support, pool.recordings.size(), values, surface_stds[name]),
          std::back_inserter(atlas));
    }
  }
  gathered.atlas_rows = atlas.size();
  return write_atlas(atlas, folder);
}

Expected<RunComparison> gather_evaluations(const TaskGraph& graph,
                                           const std::vector<TaskStatus>& states) {
  std::vector<EvaluatedRun> runs;
  for (std::size_t i = 0; i < graph.tasks.size(); ++i) {
    const Task& task = graph.tasks[i];
    if (task.stage != TaskStage::evaluate || states[i].state != TaskState::done) continue;
    const Expected<std::string> report = read_file(task.outputs.front() / "report.json");
    if (!report) return report.error();
    Expected<EvaluatedRun> run = read_run_identity(graph.tasks[task.after.front()].outputs.front());
    if (!run) return run.error();
    const Expected<void> added = add_evaluation(*report, *run);
    if (!added) return added.error();
    runs.push_back(*std::move(run));
  }
  return compare_runs(std::move(runs));
}

/// An Error where no task is done, and a warning where some are not.
Expected<void> check_done(const TaskGraph& graph, const std::vector<TaskStatus>& states,
                          const Observer& observer) {
  const auto done = std::ranges::count(states, TaskState::done, &TaskStatus::state);
  if (done == 0) {
    return Error{.message = fmt::format("none of the plan's {} tasks is done", states.size()),
                 .file = graph.results.string(),
                 .place = {},
                 .hint = "pcavr run the plan first; pcavr status names what failed"};
  }
  if (done < std::ssize(states)) {
    observer.on_warning(
        fmt::format("{} of the plan's {} tasks are not done: what they would make "
                    "is not gathered; pcavr status names them",
                    std::ssize(states) - done, states.size()));
  }
  return {};
}

}  // namespace

Expected<GatheredResults> gather_results(const TaskGraph& graph, const RunTasksOptions& options,
                                         const fs::path& folder, const Observer& observer) {
  const Expected<std::vector<TaskStatus>> states = task_states(graph);
  if (!states) return states.error();
  const Expected<void> checked = check_done(graph, *states, observer);
  if (!checked) return checked.error();
  Expected<RunComparison> comparison = gather_evaluations(graph, *states);
  if (!comparison) return comparison.error();
  GatheredResults gathered{.comparison = *std::move(comparison)};
  std::vector<Pool> pools = pools_of(graph, identified(graph, *states));
  Expected<void> done = run_pools(graph, options, pools, observer);
  if (done) done = write_parameters(pools, folder, gathered);
  if (done) done = write_run_comparison(gathered.comparison, folder);
  if (!done) return done.error();
  return gathered;
}

}  // namespace pcavr
