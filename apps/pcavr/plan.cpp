// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>

#include <fmt/core.h>

#include "pcavr/base/core/output_file.hpp"
#include "pcavr/base/core/output_paths.hpp"
#include "pcavr/pipeline/task_graph.hpp"

#include "commands.hpp"
#include "list_recordings.hpp"
#include "number_option.hpp"
#include "plan_file.hpp"
#include "scene_options.hpp"

namespace pcavr::app {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxParts = 1000;  ///< more than nodes that one disk serves

struct PlanArguments {
  std::vector<std::string> inputs;
  std::string chain = "build,identify,replay,evaluate";
  std::vector<std::string> settings;
  std::string support;
  double tile_size = 0.0;  ///< [m]; 0: none
  std::size_t parts = 4;
  std::string results;
  std::string output;
  bool replace = false;
};

/// NAME=FILE as a pair.
Expected<std::vector<std::pair<std::string, std::string>>> settings_of(
    const std::vector<std::string>& texts) {
  std::vector<std::pair<std::string, std::string>> settings;
  for (const std::string& text : texts) {
    const std::size_t at = text.find('=');
    if (at == std::string::npos || at == 0 || at + 1 == text.size()) {
      return Error{.message = "is not NAME=FILE",
                   .file = "--setting",
                   .place = text,
                   .hint = "give a name and an options file, as slow=slow.yaml"};
    }
    settings.emplace_back(text.substr(0, at), text.substr(at + 1));
  }
  return settings;
}

Expected<fs::path> results_of(const PlanArguments& arguments) {
  if (!arguments.results.empty()) return fs::path(arguments.results);
  const fs::path plan = arguments.output;
  if (plan.has_extension()) return fs::path(plan).replace_extension();
  return Error{.message = "has no extension, and its results would have the same name",
               .file = arguments.output,
               .place = {},
               .hint = "call it " + arguments.output + ".json, or give --results"};
}

CommandResult describe(const TaskGraph& graph, const std::string& file) {
  double seconds = 0.0;
  double memory = 0.0;
  for (const Task& task : graph.tasks) {
    seconds += task.estimate.seconds;
    memory = std::max(memory, task.estimate.memory);
  }
  CommandResult result;
  result.summary = fmt::format(
      "{} recordings, {} tasks: some {} on one core, up to {:.0f} MB a task\n"
      "wrote {}; results will be in {}\nnext: pcavr run {}\n",
      graph.recordings.size(), graph.tasks.size(), duration_text(seconds), memory / 1e6, file,
      graph.results.string(), file);
  result.json = {{"plan", file},
                 {"results", graph.results.string()},
                 {"recordings", graph.recordings.size()},
                 {"tasks", graph.tasks.size()},
                 {"seconds", seconds},
                 {"memory", memory}};
  return result;
}

Expected<CommandResult> make_plan(const PlanArguments& arguments, const std::string& configuration,
                                  const Observer& observer) {
  const Expected<std::vector<std::string>> recordings = list_recordings(arguments.inputs);
  if (!recordings) return recordings.error();
  const Expected<std::vector<TaskStage>> chain = parse_chain(arguments.chain);
  if (!chain) return chain.error();
  const auto settings = settings_of(arguments.settings);
  if (!settings) return settings.error();
  const Expected<fs::path> results = results_of(arguments);
  if (!results) return results.error();
  const Expected<void> apart = check_outputs(
      {arguments.output, *results}, std::vector<fs::path>(recordings->begin(), recordings->end()));
  if (!apart) return apart.error();
  Expected<OutputFile> file = OutputFile::create(
      arguments.output,
      {.replace = arguments.replace, .kind = "plan", .is_replaceable = [](const fs::path& old) {
         return read_task_graph(old).has_value();
       }});
  if (!file) return file.error();
  const Expected<TaskGraph> graph = make_task_graph({.recordings = *recordings,
                                                     .chain = *chain,
                                                     .results = *results,
                                                     .configuration = configuration,
                                                     .settings = *settings,
                                                     .support = arguments.support,
                                                     .tile_size = arguments.tile_size,
                                                     .parts = arguments.parts},
                                                    observer);
  if (!graph) return graph.error();
  Expected<void> done = file->write(format_task_graph(*graph));
  if (done) done = file->commit();
  if (!done) return done.error();
  return describe(*graph, arguments.output);
}

}  // namespace

void add_plan(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("plan", "Plan the commands for many recordings, for pcavr run");
  command->footer(
      "Example:\n  pcavr plan lab/ --chain build,identify,replay,evaluate -o pushes.json\n"
      "  pcavr run pushes.json --jobs 4");
  auto arguments = std::make_shared<PlanArguments>();
  command
      ->add_option("inputs", arguments->inputs,
                   "Recordings, folders of them, or text files with one in each line")
      ->required();
  command
      ->add_option("--chain", arguments->chain,
                   "The commands for each recording, in this order: build, identify (friction), "
                   "replay, evaluate")
      ->capture_default_str();
  command
      ->add_option("--setting", arguments->settings,
                   "NAME=FILE: replay and evaluate with these options; several to compare them")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command->add_option("--support", arguments->support,
                      "What the objects stand on, in the friction atlas; by default the name of "
                      "the folder that each recording lies in");
  CLI::Option* tiles = add_number(
      *command, "--tiles", arguments->tile_size, kTileRange,
      "Build by tiles of this edge [m], as pcavr build --tiles, with the fusion as several tasks");
  add_whole<std::size_t>(*command, "--parts", arguments->parts, 1, kMaxParts,
                         "Tasks of each recording's fusion, with --tiles")
      ->capture_default_str()
      ->needs(tiles);
  command->add_option("--results", arguments->results,
                      "Folder for what the tasks write; by default the plan's name without its "
                      "extension");
  command->add_option("-o,--output", arguments->output, "File for the plan (JSON)")->required();
  command->add_flag("--force", arguments->replace, "Replace an existing plan");
  command->callback([arguments, &app, &action] {
    const std::vector<std::string> configuration = app.get_option("--config")->results();
    action = [arguments, configuration](const Observer& observer) {
      return make_plan(*arguments, configuration.empty() ? "" : configuration.back(), observer);
    };
  });
}

}  // namespace pcavr::app
