// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop_files.hpp"

#include <cstdio>
#include <string>

#include <yaml-cpp/yaml.h>

#include "pcavr/core/output.hpp"
#include "pcavr/recording/parameters_file.hpp"

namespace pcavr {
namespace {

std::string format_predicted(const std::vector<ShownPose>& shown) {
  Trajectory predicted;
  for (const ShownPose& pose : shown) {
    predicted.append(Stamp::from_seconds(pose.t), pose.T_base_object);
  }
  return format_trajectory(predicted);
}

std::string format_forces(const Replay& replay) {
  std::string text = "t,object,measured,virtual\n";
  char numbers[96];
  for (const ForceRow& row : replay.teleop->forces) {
    std::snprintf(numbers, sizeof numbers, "%.6f,", row.t);
    text += numbers + replay.objects[row.object].name;
    std::snprintf(numbers, sizeof numbers, ",%.4f,%.4f\n", row.measured, row.predicted);
    text += numbers;
  }
  return text;
}

std::string format_phases(const Replay& replay) {
  std::string text = "t,object,measured,predicted\n";
  char stamp[32];
  for (const PhaseRow& row : replay.teleop->phases) {
    std::snprintf(stamp, sizeof stamp, "%.6f,", row.t);
    text += stamp + replay.objects[row.object].name + ',';
    text.append(name_of(row.measured)).append(",").append(name_of(row.predicted)) += '\n';
  }
  return text;
}

std::string format_corrections(const Replay& replay) {
  std::string text = "t,object,case,what,bytes\n";
  char stamp[32];
  for (const SentCorrection& sent : replay.teleop->corrections) {
    std::snprintf(stamp, sizeof stamp, "%.6f,", sent.t);
    text += stamp + replay.objects[sent.object].name + ',';
    text.append(name_of(sent.which)).append(",").append(sent.what);
    if (sent.is_lost) text += "+lost";
    text += ',' + std::to_string(sent.bytes) + '\n';
  }
  return text;
}

void emit_offset(const std::optional<TimeOffset>& offset, const char* key, YAML::Emitter& yaml) {
  if (!offset || !offset->is_known) return;
  yaml << YAML::Key << key << YAML::Value << offset->offset;
  yaml << YAML::Key << std::string(key) + "_std" << YAML::Value << offset->deviation;
}

}  // namespace

Expected<void> write_teleop_files(const Replay& replay, const std::filesystem::path& folder) {
  const TeleopRun& run = *replay.teleop;
  ParameterTable known;
  for (std::size_t i = 0; i < replay.objects.size(); ++i) {
    const std::string& name = replay.objects[i].name;
    known[name] = run.parameters[i];
    const auto predicted =
        write_file(folder / "objects" / name / "predicted.txt", format_predicted(run.shown[i]));
    if (!predicted) return predicted;
  }
  const auto forces = write_file(folder / "force.csv", format_forces(replay));
  if (!forces) return forces;
  const auto phases = write_file(folder / "phases.csv", format_phases(replay));
  if (!phases) return phases;
  const auto corrections = write_file(folder / "corrections.csv", format_corrections(replay));
  if (!corrections) return corrections;
  return write_file(folder / "parameters.yaml",
                    format_parameters(known, "what was known at the end of a replay"));
}

void emit_teleop(const Replay& replay, YAML::Emitter& yaml) {
  const TeleopRun& run = *replay.teleop;
  const TeleopOptions& options = replay.teleop_options;
  yaml << YAML::Key << "parameters" << YAML::Value << replay.parameters_file;
  yaml << YAML::Key << "forward_delay" << YAML::Value << options.forward_delay;
  yaml << YAML::Key << "backward_delay" << YAML::Value << options.backward_delay;
  yaml << YAML::Key << "jitter" << YAML::Value << options.jitter;
  yaml << YAML::Key << "loss" << YAML::Value << options.loss;
  yaml << YAML::Key << "seed" << YAML::Value << options.seed;
  yaml << YAML::Key << "corrections" << YAML::Value << options.with_corrections;
  yaml << YAML::Key << "identifies" << YAML::Value << options.identifies;
  yaml << YAML::Key << "time_offset" << YAML::Value << YAML::BeginMap;
  emit_offset(run.tool_to_force, "tool_to_force", yaml);
  emit_offset(run.tool_to_camera, "tool_to_camera", yaml);
  yaml << YAML::EndMap;
  yaml << YAML::Key << "traffic" << YAML::Value << YAML::BeginMap;
  yaml << YAML::Key << "correction_bytes" << YAML::Value << run.correction_bytes;
  yaml << YAML::Key << "streaming_bytes" << YAML::Value << run.streaming_bytes << YAML::EndMap;
  yaml << YAML::Key << "assumed" << YAML::Value << YAML::BeginMap;
  for (std::size_t i = 0; i < replay.objects.size(); ++i) {
    yaml << YAML::Key << replay.objects[i].name << YAML::Value << YAML::Flow << run.assumed[i];
  }
  yaml << YAML::EndMap;
  yaml << YAML::Key << "notes" << YAML::Value << run.notes;
}

}  // namespace pcavr
