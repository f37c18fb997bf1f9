// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "evaluate_runs.hpp"

#include <filesystem>
#include <utility>

#include <fmt/core.h>

#include "pcavr/base/report/report_page.hpp"
#include "pcavr/results/evaluation/compare_runs.hpp"
#include "pcavr/results/evaluation/evaluate.hpp"

#include "output_option.hpp"

namespace pcavr::app {
namespace {

namespace fs = std::filesystem;

Expected<void> check_arguments(const EvaluateArguments& arguments) {
  for (const auto& [option, value] :
       {std::pair("--truth", &arguments.truth), std::pair("--reference", &arguments.reference)}) {
    if (value->empty()) continue;
    return Error{.message = fmt::format("is for one run, not for {}", arguments.subjects.size()),
                 .file = option,
                 .place = {},
                 .hint = "give --own-truth, or leave it out to compare with the runs' tracking"};
  }
  for (const std::string& subject : arguments.subjects) {
    std::error_code code;
    if (fs::is_regular_file(fs::path(subject) / "run.yaml", code)) continue;
    return Error{
        .message = "is not a run: it has no run.yaml",
        .file = subject,
        .place = {},
        .hint = "give folders from pcavr replay; scenes and parameter files one at a time"};
  }
  return {};
}

/// The folder truth of a run's recording.
Expected<fs::path> own_truth(const EvaluatedRun& run) {
  fs::path truth = fs::path(run.recording) / "truth";
  std::error_code code;
  if (fs::is_directory(truth, code)) return truth;
  return Error{.message = "the run's recording has no folder truth: " + truth.string(),
               .file = run.run,
               .place = {},
               .hint =
                   "leave --own-truth out, or call the command where the recording's path leads "
                   "to it"};
}

Expected<EvaluatedRun> evaluate_one(const fs::path& folder, const EvaluateArguments& arguments,
                                    Configuration& configuration, const Observer& observer) {
  Expected<EvaluatedRun> run = read_run_identity(folder);
  if (!run) return run;
  EvaluationInput input{.subject = folder,
                        .options = configuration.evaluation,
                        .configuration = configuration.changed()};
  if (arguments.own_truth) {
    const Expected<fs::path> truth = own_truth(*run);
    if (!truth) return truth.error();
    input.reference = *truth;
  }
  const Expected<std::string> report = evaluation_metrics(input, {arguments.threads}, observer);
  if (!report) return report.error();
  const Expected<void> added = add_evaluation(*report, *run);
  if (!added) return added.error();
  return run;
}

}  // namespace

Expected<CommandResult> evaluate_runs(const EvaluateArguments& arguments,
                                      Configuration& configuration, const Observer& observer) {
  const Expected<void> checked = check_arguments(arguments);
  if (!checked) return checked.error();
  const std::vector<fs::path> inputs(arguments.subjects.begin(), arguments.subjects.end());
  Expected<OutputFolder> folder = create_output(arguments.output, OutputKind::report, inputs);
  if (!folder) return folder.error();
  std::vector<EvaluatedRun> runs;
  for (const fs::path& run : inputs) {
    Expected<EvaluatedRun> evaluated = evaluate_one(run, arguments, configuration, observer);
    if (!evaluated) return evaluated.error();
    runs.push_back(*std::move(evaluated));
    observer.on_progress("evaluating runs", runs.size(), inputs.size());
  }
  const Expected<RunComparison> comparison = compare_runs(std::move(runs));
  if (!comparison) return comparison.error();
  Expected<void> done = write_run_comparison(*comparison, folder->path());
  if (done) done = folder->commit();
  if (!done) return done.error();
  return CommandResult{
      .summary = run_comparison_text(*comparison) + how_to_open(arguments.output.folder) + '\n',
      .json = nlohmann::ordered_json::parse(run_comparison_json(*comparison))};
}

}  // namespace pcavr::app
