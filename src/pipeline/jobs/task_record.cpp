// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "task_record.hpp"

#include <nlohmann/json.hpp>

#include "pcavr/base/core/json_text.hpp"
#include "pcavr/base/core/output.hpp"

#include "sha256.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

constexpr char kRecordFormat[] = "pcavr-task/1";

TaskRecord record_of(const Json& json) {
  TaskRecord record{.key = json.at("key").get<std::string>(),
                    .is_done = json.at("state").get<std::string>() == "done",
                    .reason = json.at("reason").get<std::string>(),
                    .seconds = json.at("seconds").get<double>(),
                    .cpu_seconds = json.at("cpu_seconds").get<double>(),
                    .memory = json.at("memory").get<double>()};
  for (const Json& output : json.at("outputs")) {
    record.outputs.push_back(
        {output.at("sha256").get<std::string>(), output.at("listing").get<std::string>()});
  }
  return record;
}

}  // namespace

fs::path task_file(const TaskGraph& graph, const Task& task, const std::string& extension) {
  return graph.results / (task.name + extension);
}

std::optional<TaskRecord> read_task_record(const fs::path& file) {
  const Expected<std::string> text = read_file(file);
  if (!text) return std::nullopt;
  try {
    const Json json = Json::parse(*text);
    if (json.at("format").get<std::string>() != kRecordFormat) return std::nullopt;
    return record_of(json);
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  }
}

Expected<void> write_task_record(const TaskRecord& record, const fs::path& file) {
  Json json{{"format", kRecordFormat},
            {"version", PCAVR_VERSION},
            {"key", record.key},
            {"state", record.is_done ? "done" : "failed"},
            {"reason", record.reason},
            {"seconds", record.seconds},
            {"cpu_seconds", record.cpu_seconds},
            {"memory", record.memory},
            {"outputs", Json::array()}};
  for (const InputContent& output : record.outputs)
    json["outputs"].push_back({{"sha256", output.content}, {"listing", output.listing}});
  return write_file(file, json_text(json, 1) + '\n');
}

std::string key_of(const TaskGraph& graph, const Task& task,
                   const std::vector<std::string>& inputs) {
  Sha256 hash;
  hash.add_text(kRecordFormat);
  hash.add_text(PCAVR_VERSION);
  for (const std::string& word : task.command) hash.add_text(word);
  for (const std::size_t one : task.recordings) {
    const PlannedRecording& recording = graph.recordings[one];
    hash.add_text(recording.files.content);
    if (task.stage == TaskStage::evaluate && recording.truth)
      hash.add_text(recording.truth->content);
  }
  const std::optional<PlannedInput>& configuration =
      task.setting ? graph.settings[*task.setting].configuration : graph.configuration;
  hash.add_text(configuration ? configuration->content : std::string());
  for (const std::string& input : inputs) hash.add_text(input);
  return hash.digest();
}

bool proves_done(const TaskRecord& record, const std::string& key, const Task& task) {
  if (!record.is_done || record.key != key || record.outputs.size() != task.outputs.size())
    return false;
  for (std::size_t i = 0; i < task.outputs.size(); ++i) {
    const Expected<bool> unchanged = is_unchanged(record.outputs[i], task.outputs[i]);
    if (!unchanged || !*unchanged) return false;
  }
  return true;
}

std::string content_of_outputs(const TaskRecord& record) {
  Sha256 hash;
  for (const InputContent& output : record.outputs) hash.add_text(output.content);
  return hash.digest();
}

}  // namespace pcavr
