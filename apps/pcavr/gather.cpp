// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>

#include <fmt/core.h>

#include "pcavr/base/core/parallel.hpp"
#include "pcavr/base/report/report_page.hpp"
#include "pcavr/pipeline/gather_results.hpp"

#include "commands.hpp"
#include "number_option.hpp"
#include "output_option.hpp"
#include "plan_file.hpp"

namespace pcavr::app {
namespace {

struct GatherArguments {
  std::string plan;
  OutputOption output;
  int jobs = 1;
};

CommandResult describe(const GatheredResults& gathered, const std::string& folder) {
  CommandResult result;
  result.summary = fmt::format("{} evaluated runs, {} objects, {} rows of the friction atlas\n",
                               gathered.comparison.runs.size(), gathered.comparison.objects.size(),
                               gathered.atlas_rows);
  if (!gathered.comparison.runs.empty()) result.summary += run_comparison_text(gathered.comparison);
  result.summary += how_to_open(folder) + '\n';
  result.json = nlohmann::ordered_json::parse(run_comparison_json(gathered.comparison));
  result.json["folder"] = folder;
  result.json["atlas_rows"] = gathered.atlas_rows;
  return result;
}

Expected<CommandResult> gather(const GatherArguments& arguments, const Observer& observer) {
  const Expected<TaskGraph> graph = read_valid_plan(arguments.plan);
  if (!graph) return graph.error();
  const Expected<std::filesystem::path> command = own_command();
  if (!command) return command.error();
  std::vector<std::filesystem::path> inputs{arguments.plan, graph->results};
  for (const PlannedRecording& recording : graph->recordings)
    inputs.push_back(recording.files.path);
  Expected<OutputFolder> folder = create_output(arguments.output, OutputKind::report, inputs);
  if (!folder) return folder.error();
  const Expected<GatheredResults> gathered = gather_results(
      *graph, {.command = *command, .jobs = arguments.jobs}, folder->path(), observer);
  if (!gathered) return gathered.error();
  const Expected<void> committed = folder->commit();
  if (!committed) return committed.error();
  return describe(*gathered, arguments.output.folder);
}

}  // namespace

void add_gather(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "gather", "Collect a plan's results: evaluations, parameters by object, friction atlas");
  command->footer("Example:\n  pcavr gather pushes.json -o pushes_report");
  auto arguments = std::make_shared<GatherArguments>();
  command->add_option("plan", arguments->plan, "Plan from pcavr plan")->required();
  add_output_option(*command, arguments->output,
                    "Folder for the tables, the parameter files and the report");
  add_whole<int>(*command, "--jobs", arguments->jobs, 1, kMaxJobs,
                 "Identifications of many recordings at a time")
      ->capture_default_str();
  command->callback([arguments, &action] {
    action = [arguments](const Observer& observer) { return gather(*arguments, observer); };
  });
}

}  // namespace pcavr::app
