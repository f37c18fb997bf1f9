// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "pcavr/base/core/json_text.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/pipeline/task_graph.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

constexpr char kPlanFormat[] = "pcavr-plan/1";

Json json_of(const PlannedInput& input) {
  return {{"path", input.path.string()}, {"sha256", input.content}, {"listing", input.listing}};
}

Json json_of(const std::optional<PlannedInput>& input) {
  return input ? json_of(*input) : Json(nullptr);
}

Json json_of(const PlannedRecording& recording) {
  return {{"name", recording.name},
          {"support", recording.support},
          {"files", json_of(recording.files)},
          {"truth", json_of(recording.truth)},
          {"objects", recording.objects},
          {"frames", recording.frames},
          {"samples", recording.samples}};
}

Json json_of(const Task& task, std::size_t number) {
  Json json{{"task", number},
            {"name", task.name},
            {"stage", name_of(task.stage)},
            {"recordings", task.recordings},
            {"setting", task.setting ? Json(*task.setting) : Json(nullptr)},
            {"after", task.after},
            {"command", task.command},
            {"outputs", Json::array()},
            {"seconds", task.estimate.seconds},
            {"memory", task.estimate.memory}};
  for (const fs::path& output : task.outputs) json["outputs"].push_back(output.string());
  return json;
}

PlannedInput input_of(const Json& json) {
  return {json.at("path").get<std::string>(), json.at("sha256").get<std::string>(),
          json.at("listing").get<std::string>()};
}

std::optional<PlannedInput> optional_input(const Json& json) {
  return json.is_null() ? std::nullopt : std::optional(input_of(json));
}

PlannedRecording recording_of(const Json& json) {
  return {.name = json.at("name").get<std::string>(),
          .support = json.at("support").get<std::string>(),
          .files = input_of(json.at("files")),
          .truth = optional_input(json.at("truth")),
          .objects = json.at("objects").get<std::vector<std::string>>(),
          .frames = json.at("frames").get<std::size_t>(),
          .samples = json.at("samples").get<std::size_t>()};
}

TaskStage stage_of(const std::string& name) {
  for (const TaskStage stage : {TaskStage::survey, TaskStage::fuse, TaskStage::build,
                                TaskStage::identify, TaskStage::replay, TaskStage::evaluate}) {
    if (name == name_of(stage)) return stage;
  }
  throw std::out_of_range("has no stage " + name);
}

Task task_of(const Json& json) {
  Task task{.name = json.at("name").get<std::string>(),
            .stage = stage_of(json.at("stage").get<std::string>()),
            .recordings = json.at("recordings").get<std::vector<std::size_t>>(),
            .setting = {},
            .after = json.at("after").get<std::vector<std::size_t>>(),
            .command = json.at("command").get<std::vector<std::string>>(),
            .outputs = {},
            .estimate = {json.at("seconds").get<double>(), json.at("memory").get<double>()}};
  const Json& setting = json.at("setting");
  if (!setting.is_null()) task.setting = setting.get<std::size_t>();
  for (const Json& output : json.at("outputs"))
    task.outputs.emplace_back(output.get<std::string>());
  return task;
}

/// Throws where an index is not one of what the plan has before it.
void check_indices(const TaskGraph& graph) {
  const auto check = [](std::size_t index, std::size_t size, const char* what) {
    if (index >= size) throw std::out_of_range(fmt::format("has no {} {}", what, index));
  };
  for (std::size_t i = 0; i < graph.tasks.size(); ++i) {
    const Task& task = graph.tasks[i];
    for (const std::size_t before : task.after) check(before, i, "earlier task");
    for (const std::size_t one : task.recordings) check(one, graph.recordings.size(), "recording");
    if (task.setting) check(*task.setting, graph.settings.size(), "setting");
    if (task.recordings.empty() || task.outputs.empty() || task.command.empty())
      throw std::out_of_range("has a task without recording, output or command");
  }
}

TaskGraph graph_of(const Json& json) {
  if (json.at("format").get<std::string>() != kPlanFormat)
    throw std::out_of_range("is of another format or version");
  TaskGraph graph{.version = json.at("version").get<std::string>(),
                  .results = json.at("results").get<std::string>(),
                  .configuration = optional_input(json.at("configuration"))};
  for (const Json& one : json.at("recordings")) graph.recordings.push_back(recording_of(one));
  for (const Json& one : json.at("settings"))
    graph.settings.push_back(
        {one.at("name").get<std::string>(), optional_input(one.at("configuration"))});
  for (const Json& one : json.at("tasks")) graph.tasks.push_back(task_of(one));
  check_indices(graph);
  return graph;
}

}  // namespace

std::string format_task_graph(const TaskGraph& graph) {
  Json json{{"format", kPlanFormat},
            {"version", graph.version},
            {"results", graph.results.string()},
            {"configuration", json_of(graph.configuration)},
            {"recordings", Json::array()},
            {"settings", Json::array()},
            {"tasks", Json::array()}};
  for (const PlannedRecording& one : graph.recordings) json["recordings"].push_back(json_of(one));
  for (const ReplaySetting& one : graph.settings)
    json["settings"].push_back({{"name", one.name}, {"configuration", json_of(one.configuration)}});
  for (std::size_t i = 0; i < graph.tasks.size(); ++i)
    json["tasks"].push_back(json_of(graph.tasks[i], i));
  return json_text(json, 1) + '\n';
}

Expected<TaskGraph> read_task_graph(const fs::path& file) {
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  try {
    return graph_of(Json::parse(*text));
  } catch (const std::exception& failure) {
    return Error{.message = std::string("is no plan of pcavr: ") + failure.what(),
                 .file = file.string(),
                 .place = {},
                 .hint = "make it with pcavr plan"};
  }
}

}  // namespace pcavr
