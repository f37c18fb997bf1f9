// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/results/evaluation/evaluate.hpp"

#include <filesystem>

#include <fmt/core.h>

#include "pcavr/base/report/report_page.hpp"

#include "commands.hpp"
#include "evaluate_runs.hpp"
#include "output_option.hpp"

namespace pcavr::app {
namespace {

/// The report's headline figures, a line each.
std::string headline(const nlohmann::ordered_json& report) {
  std::string text;
  for (const auto& figure : report.at("headline")) {
    text += fmt::format("  {:<58} {:>10.3f} {}\n", figure.at("name").get<std::string>(),
                        figure.at("value").get<double>(), figure.at("unit").get<std::string>());
  }
  return text;
}

Expected<CommandResult> run_evaluation(const EvaluateArguments& arguments,
                                       Configuration& configuration, const Observer& observer) {
  const std::string& subject = arguments.subjects.front();
  if (std::filesystem::path(subject).extension() == ".mcap") {
    return Error{.message = "is a log, not a run",
                 .file = subject,
                 .hint = "make a run of it: pcavr replay " + subject + " --scene SCENE -o RUN"};
  }
  Expected<OutputFolder> folder = create_output(arguments.output, OutputKind::report,
                                                {subject, arguments.truth, arguments.reference});
  if (!folder) return folder.error();
  const EvaluationInput input{
      .subject = subject,
      .reference = arguments.truth.empty() ? arguments.reference : arguments.truth,
      .options = configuration.evaluation,
      .configuration = configuration.changed()};
  const Expected<std::string> report =
      evaluate(input, folder->path(), {arguments.threads}, observer);
  if (!report) return report.error();
  const Expected<void> committed = folder->commit();
  if (!committed) return committed.error();
  CommandResult result;
  result.json = nlohmann::ordered_json::parse(*report);
  result.summary = headline(result.json) + how_to_open(arguments.output.folder) + '\n';
  return result;
}

}  // namespace

void add_evaluate(CLI::App& app, Configuration& configuration, Action& action) {
  CLI::App* command = app.add_subcommand(
      "evaluate", "Compare a scene, a run or identified parameters with the ground truth");
  command->footer(
      "Example:\n  pcavr evaluate my_run --truth my_recording/truth -o my_report\n"
      "--truth is optional for a run: without it, its prediction is compared with its tracking.\n"
      "Several runs, one table:\n  pcavr evaluate run_1 run_2 run_3 --own-truth -o my_report");
  auto arguments = std::make_shared<EvaluateArguments>();
  command
      ->add_option("subject", arguments->subjects,
                   "Folder of a scene or a run, or a parameter file; or the folders of several "
                   "runs: one table, and the differences between settings")
      ->required();
  CLI::Option_group* against = command->add_option_group("against", "What to compare with");
  against->add_option("--truth", arguments->truth, "Ground truth: a recording's truth folder");
  against->add_option("--reference", arguments->reference, "A second scene, run or parameter file");
  against->add_flag("--own-truth", arguments->own_truth,
                    "Several runs: each against the folder truth of its recording");
  against->require_option(0, 1);
  add_output_option(*command, arguments->output, "Folder for report.json and report.html");
  add_threads_option(*command, arguments->threads);
  command->callback([arguments, &configuration, &action] {
    action = [arguments, &configuration](const Observer& observer) {
      if (arguments->subjects.size() > 1 || arguments->own_truth)
        return evaluate_runs(*arguments, configuration, observer);
      return run_evaluation(*arguments, configuration, observer);
    };
  });
}

}  // namespace pcavr::app
