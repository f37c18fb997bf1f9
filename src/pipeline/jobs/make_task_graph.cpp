// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <sstream>
#include <utility>

#include <fmt/core.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/output_paths.hpp"

#include "planned_recordings.hpp"
#include "task_estimates.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

struct StageName {
  TaskStage stage;
  std::string_view name;
};
constexpr std::array<StageName, 7> kStages{{{TaskStage::survey, "survey"},
                                            {TaskStage::fuse, "fuse"},
                                            {TaskStage::build, "build"},
                                            {TaskStage::identify, "identify"},
                                            {TaskStage::replay, "replay"},
                                            {TaskStage::evaluate, "evaluate"},
                                            {TaskStage::pool, "pool"}}};

/// The indices of the tasks of one recording, as they are made.
struct Made {
  std::optional<std::size_t> survey = {};  ///< of a build by tiles
  std::vector<std::size_t> tiles = {};     ///< by part
  std::optional<std::size_t> scene = {};
  std::optional<std::size_t> parameters = {};
  std::vector<std::size_t> runs = {};  ///< by setting
};

class GraphBuilder {
 public:
  GraphBuilder(TaskGraph& graph, const TaskGraphRequest& request)
      : graph_(graph), request_(request), made_(graph.recordings.size()) {}

  void add_stage(TaskStage stage) {
    const bool by_setting = stage == TaskStage::replay || stage == TaskStage::evaluate;
    const std::size_t settings = by_setting ? graph_.settings.size() : 1;
    for (std::size_t setting = 0; setting < settings; ++setting) {
      for (std::size_t i = 0; i < graph_.recordings.size(); ++i) add(stage, i, setting);
    }
  }

 private:
  void add(TaskStage stage, std::size_t recording, std::size_t setting) {
    switch (stage) {
      case TaskStage::survey:
        return add_survey(recording);
      case TaskStage::fuse:
        return add_fuse(recording);
      case TaskStage::build:
        return add_build(recording);
      case TaskStage::identify:
        return add_identify(recording);
      case TaskStage::replay:
        return add_replay(recording, setting);
      case TaskStage::evaluate:
        return add_evaluate(recording, setting);
      case TaskStage::pool:
        return;
    }
  }

  [[nodiscard]] const PlannedRecording& at(std::size_t i) const { return graph_.recordings[i]; }
  [[nodiscard]] std::string source(std::size_t i) const { return at(i).files.path.string(); }

  /// "run", or "run-NAME" where there are several settings.
  [[nodiscard]] std::string with_setting(const std::string& name, std::size_t setting) const {
    if (graph_.settings.size() == 1) return name;
    return name + '-' + graph_.settings[setting].name;
  }

  Task task(TaskStage stage, std::size_t i, const std::string& name,
            const std::vector<std::string>& outputs) const {
    Task task{.name = at(i).name + '/' + name, .stage = stage, .recordings = {i}};
    for (const std::string& output : outputs)
      task.outputs.push_back(graph_.results / at(i).name / output);
    task.estimate = estimate_task(stage, at(i).frames, at(i).samples);
    return task;
  }

  /// Adds options of the command and returns the task's index.
  std::size_t append(Task task, const std::optional<PlannedInput>& configuration) {
    if (configuration) {
      task.command.insert(task.command.end(), {"--config", configuration->path.string()});
    }
    graph_.tasks.push_back(std::move(task));
    return graph_.tasks.size() - 1;
  }

  void read_output(const std::string& option, std::optional<std::size_t> of, Task& task) const {
    if (!of) return;
    task.command.insert(task.command.end(), {option, graph_.tasks[*of].outputs.front().string()});
    task.after.push_back(*of);
  }

  [[nodiscard]] std::string tile_size() const { return fmt::format("{}", request_.tile_size); }

  void add_survey(std::size_t i) {
    if (at(i).frames == 0) return;  // built from its manifest alone
    Task made = task(TaskStage::survey, i, "survey", {"survey.tiles"});
    made.command = {"survey", source(i), "-o", made.outputs[0].string(), "--tiles", tile_size()};
    made_[i].survey = append(std::move(made), graph_.configuration);
  }

  void add_fuse(std::size_t i) {
    if (!made_[i].survey) return;
    for (std::size_t part = 1; part <= request_.parts; ++part) {
      const std::string name = fmt::format("fuse-{}", part);
      Task made = task(TaskStage::fuse, i, name, {name + ".tiles"});
      made.estimate.seconds /= static_cast<double>(request_.parts);
      made.command = {"fuse",   source(i),
                      "-o",     made.outputs[0].string(),
                      "--part", fmt::format("{}/{}", part, request_.parts)};
      read_output("--survey", made_[i].survey, made);
      made_[i].tiles.push_back(append(std::move(made), graph_.configuration));
    }
  }

  void add_build(std::size_t i) {
    Task made = task(TaskStage::build, i, "build", {"scene"});
    made.command = {"build", source(i), "-o", made.outputs[0].string()};
    if (made_[i].survey) {
      read_output("--survey", made_[i].survey, made);
      made.command.push_back("--fused");
      for (const std::size_t part : made_[i].tiles) {
        made.after.push_back(part);
        made.command.push_back(graph_.tasks[part].outputs.front().string());
      }
    }
    made_[i].scene = append(std::move(made), graph_.configuration);
  }

  void add_identify(std::size_t i) {
    Task made = task(TaskStage::identify, i, "identify", {"parameters.yaml", "parameters.report"});
    made.command = {"identify",
                    "friction",
                    source(i),
                    "-o",
                    made.outputs[0].string(),
                    "--report",
                    made.outputs[1].string()};
    read_output("--scene", made_[i].scene, made);
    made_[i].parameters = append(std::move(made), graph_.configuration);
  }

  void add_replay(std::size_t i, std::size_t setting) {
    Task made =
        task(TaskStage::replay, i, with_setting("replay", setting), {with_setting("run", setting)});
    made.setting = setting;
    made.command = {"replay", source(i), "-o", made.outputs[0].string()};
    read_output("--scene", made_[i].scene, made);
    read_output("--parameters", made_[i].parameters, made);
    made_[i].runs.push_back(append(std::move(made), graph_.settings[setting].configuration));
  }

  void add_evaluate(std::size_t i, std::size_t setting) {
    Task made = task(TaskStage::evaluate, i, with_setting("evaluate", setting),
                     {with_setting("report", setting)});
    const std::size_t run = made_[i].runs[setting];
    made.setting = setting;
    made.after = {run};
    made.command = {"evaluate", graph_.tasks[run].outputs[0].string(), "-o",
                    made.outputs[0].string()};
    if (at(i).truth)
      made.command.insert(made.command.end(), {"--truth", at(i).truth->path.string()});
    append(std::move(made), graph_.settings[setting].configuration);
  }

  TaskGraph& graph_;
  const TaskGraphRequest& request_;
  std::vector<Made> made_;
};

/// Stages that a chain names; the others are added to it.
bool is_of_chain(TaskStage stage) {
  return stage != TaskStage::survey && stage != TaskStage::fuse && stage != TaskStage::pool;
}

Error chain_error(const std::string& text, const std::string& why) {
  return {.message = why,
          .file = "--chain",
          .place = text,
          .hint = "give build,identify,replay,evaluate, or a part of it in this order"};
}

bool is_setting_name(const std::string& name) {
  constexpr std::string_view kAllowed =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-";
  return !name.empty() && name.front() != '.' &&
         name.find_first_not_of(kAllowed) == std::string::npos;
}

Expected<std::vector<ReplaySetting>> settings_of(const TaskGraphRequest& request,
                                                 const std::optional<PlannedInput>& configuration) {
  if (request.settings.empty()) return std::vector{ReplaySetting{"default", configuration}};
  std::vector<ReplaySetting> settings;
  for (const auto& [name, file] : request.settings) {
    const bool is_new = std::ranges::find(settings, name, &ReplaySetting::name) == settings.end();
    if (!is_new || !is_setting_name(name)) {
      return Error{.message = is_new ? "is no name of a setting" : "is given twice",
                   .file = "--setting",
                   .place = name,
                   .hint = "give each another name, of letters, digits, '.', '_' and '-'"};
    }
    Expected<PlannedInput> input = planned_input(file);
    if (!input) return input.error();
    settings.push_back({name, *std::move(input)});
  }
  return settings;
}

}  // namespace

std::string_view name_of(TaskStage stage) {
  return std::ranges::find(kStages, stage, &StageName::stage)->name;
}

Expected<std::vector<TaskStage>> parse_chain(const std::string& text) {
  std::vector<TaskStage> chain;
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, ',');) {
    const auto* const found = std::ranges::find(kStages, word, &StageName::name);
    if (found == kStages.end() || !is_of_chain(found->stage))
      return chain_error(text, "has no stage '" + word + "'");
    if (!chain.empty() && chain.back() >= found->stage)
      return chain_error(text, "has '" + word + "' twice, or after a later stage");
    chain.push_back(found->stage);
  }
  const auto has = [&](TaskStage stage) { return std::ranges::count(chain, stage) > 0; };
  if (chain.empty()) return chain_error(text, "is empty");
  if (has(TaskStage::replay) && !has(TaskStage::build))
    return chain_error(text, "has replay without build, which makes its scene");
  if (has(TaskStage::evaluate) && !has(TaskStage::replay))
    return chain_error(text, "has evaluate without replay, which makes its run");
  return chain;
}

Expected<TaskGraph> make_task_graph(const TaskGraphRequest& request, const Observer& observer) {
  PCAVR_REQUIRE(!request.recordings.empty() && !request.chain.empty());
  const Expected<fs::path> results = resolve_path(request.results);
  if (!results) return results.error();
  TaskGraph graph{.version = PCAVR_VERSION, .results = *results};
  if (!request.configuration.empty()) {
    Expected<PlannedInput> configuration = planned_input(request.configuration);
    if (!configuration) return configuration.error();
    graph.configuration = *std::move(configuration);
  }
  Expected<std::vector<ReplaySetting>> settings = settings_of(request, graph.configuration);
  if (!settings) return settings.error();
  graph.settings = *std::move(settings);
  Expected<std::vector<PlannedRecording>> recordings =
      planned_recordings(request.recordings, request.support, observer);
  if (!recordings) return recordings.error();
  graph.recordings = *std::move(recordings);
  GraphBuilder builder(graph, request);
  for (const TaskStage stage : request.chain) {
    if (stage == TaskStage::build && request.tile_size > 0.0) {
      builder.add_stage(TaskStage::survey);
      builder.add_stage(TaskStage::fuse);
    }
    builder.add_stage(stage);
  }
  return graph;
}

}  // namespace pcavr
