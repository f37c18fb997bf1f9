// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>

#include <fmt/core.h>

#include "pcavr/base/core/output_paths.hpp"
#include "pcavr/base/core/parallel.hpp"
#include "pcavr/pipeline/run_tasks.hpp"
#include "pcavr/pipeline/slurm_scripts.hpp"

#include "commands.hpp"
#include "number_option.hpp"
#include "plan_file.hpp"

namespace pcavr::app {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxTask = 10'000'000;

struct RunArguments {
  std::string plan;
  int jobs = 1;
  int threads = 0;  ///< 0: the cores, divided among the jobs
  std::optional<std::size_t> task = {};
  std::string submit;
  bool dry_run = false;
};

CommandResult describe(const TaskGraph& graph, const TasksRun& run,
                       std::optional<std::size_t> only) {
  const std::size_t failed = only ? 0 : count_of(run.states, TaskState::failed);
  const std::size_t skipped = only ? 0 : count_of(run.states, TaskState::skipped);
  CommandResult result;
  result.is_failure = only ? run.states[*only].state != TaskState::done : failed + skipped > 0;
  result.summary =
      fmt::format("{} tasks run, {} were done before, {} failed, {} skipped\n", run.ran,
                  run.were_done, only && result.is_failure ? 1 : failed, skipped);
  result.json = {{"ran", run.ran},
                 {"were_done", run.were_done},
                 {"failed", nlohmann::ordered_json::array()},
                 {"skipped", nlohmann::ordered_json::array()}};
  for (std::size_t i = 0; i < run.states.size(); ++i) {
    const TaskStatus& status = run.states[i];
    if ((only && *only != i) || status.reason.empty()) continue;
    result.json[std::string(name_of(status.state))].push_back(
        {{"task", i}, {"name", graph.tasks[i].name}, {"reason", status.reason}});
  }
  return result;
}

Expected<CommandResult> run_here(const RunArguments& arguments, const TaskGraph& graph,
                                 const Observer& observer) {
  const Expected<fs::path> command = own_command();
  if (!command) return command.error();
  const int cores = Parallelism::max().threads;
  const int shared = std::max(1, cores / arguments.jobs);
  const int threads = arguments.threads > 0 ? arguments.threads : shared;
  const Expected<TasksRun> run = run_tasks(
      graph,
      {.command = *command, .jobs = arguments.jobs, .threads = threads, .only = arguments.task},
      observer);
  if (!run) return run.error();
  return describe(graph, *run, arguments.task);
}

Expected<CommandResult> submit(const RunArguments& arguments, const TaskGraph& graph) {
  const Expected<fs::path> command = own_command();
  if (!command) return command.error();
  const Expected<fs::path> plan = resolve_path(arguments.plan);
  if (!plan) return plan.error();
  const std::vector<SlurmScript> scripts = slurm_scripts(graph, *plan, *command);
  const fs::path folder = graph.results / "slurm";
  CommandResult result;
  result.json = {{"folder", folder.string()}, {"submitted", false}};
  if (arguments.dry_run) {
    for (const SlurmScript& script : scripts) {
      result.summary += fmt::format("# {}\n{}", (folder / script.name).string(), script.text);
      result.json["scripts"][script.name] = script.text;
    }
    return result;
  }
  const Expected<bool> is_submitted = submit_to_slurm(scripts, folder);
  if (!is_submitted) return is_submitted.error();
  result.json["submitted"] = *is_submitted;
  const std::string script = (folder / kSubmitScript).string();
  result.summary = *is_submitted
                       ? "submitted, see " + (folder / "submit.log").string() + '\n'
                       : "wrote " + script + "; there is no sbatch here: call it on the cluster\n";
  return result;
}

Expected<CommandResult> run_plan(const RunArguments& arguments, const Observer& observer) {
  const Expected<TaskGraph> graph = read_valid_plan(arguments.plan, arguments.task);
  if (!graph) return graph.error();
  if (!arguments.submit.empty()) return submit(arguments, *graph);
  return run_here(arguments, *graph, observer);
}

}  // namespace

void add_run(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("run", "Run the tasks of a plan that are not done, here or by Slurm");
  command->footer(
      "Example:\n  pcavr run pushes.json --jobs 4\n  pcavr run pushes.json --submit slurm");
  auto arguments = std::make_shared<RunArguments>();
  command->add_option("plan", arguments->plan, "Plan from pcavr plan")->required();
  add_whole<int>(*command, "--jobs", arguments->jobs, 1, kMaxJobs, "Tasks at a time")
      ->capture_default_str();
  add_whole<int>(*command, "--threads", arguments->threads, 1, kMaxJobs,
                 "Threads of each task; by default the cores, divided among the jobs");
  CLI::Option* task =
      command
          ->add_option_function<std::size_t>(
              "--task", [arguments](std::size_t number) { arguments->task = number; },
              "Run this task alone, by its number; those that it needs must be done")
          ->check(CLI::Range(std::size_t{0}, kMaxTask));
  CLI::Option* slurm = command
                           ->add_option("--submit", arguments->submit,
                                        "Write job arrays for a cluster, and submit them where it "
                                        "has sbatch")
                           ->check(CLI::IsMember({"slurm"}))
                           ->excludes(task);
  command->add_flag("--dry-run", arguments->dry_run, "Print the scripts of --submit instead")
      ->needs(slurm);
  command->callback([arguments, &action] {
    action = [arguments](const Observer& observer) { return run_plan(*arguments, observer); };
  });
}

}  // namespace pcavr::app
