// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop_files.hpp"

#include <string>
#include <vector>

#include <fmt/core.h>
#include <yaml-cpp/yaml.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/core/utf8.hpp"
#include "pcavr/physics/object/parameters_file.hpp"

#include "run_writer.hpp"

namespace pcavr {
namespace {

/// Writes the data that a run without a run_folder kept in memory.
Expected<void> write_kept(const Replay& replay, const std::filesystem::path& folder) {
  const TeleopRun& run = *replay.teleop;
  TeleopWriter writer;
  Expected<void> done = writer.open(folder, object_names(replay));
  for (std::size_t i = 0; i < run.shown.size(); ++i) {
    for (const ShownPose& shown : run.shown[i]) {
      if (done) done = writer.add_shown(i, shown);
    }
  }
  for (const ForceRow& row : run.forces) {
    if (done) done = writer.add_force(row);
  }
  for (const SentCorrection& sent : run.corrections) {
    if (done) done = writer.add_correction(sent);
  }
  for (const ParameterRow& row : run.parameter_rows) {
    if (done) done = writer.add_parameter(row);
  }
  if (!done) return done;
  return writer.close();
}

std::string format_phases(const Replay& replay) {
  std::string text = "t,object,measured,predicted\n";
  for (const PhaseRow& row : replay.teleop->phases) {
    text += fmt::format("{:.6f},{},{},{}\n", row.t, replay.objects[row.object].name,
                        name_of(row.measured), name_of(row.predicted));
  }
  return text;
}

void emit_offset(const TimeOffset& offset, const char* key, YAML::Emitter& yaml) {
  if (!offset.is_known) return;
  yaml << YAML::Key << key << YAML::Value << offset.offset;
  yaml << YAML::Key << std::string(key) + "_std" << YAML::Value << offset.std;
}

}  // namespace

Expected<void> write_teleop_files(const Replay& replay, const std::filesystem::path& folder) {
  const TeleopRun& run = *replay.teleop;
  ParameterTable known;
  for (std::size_t i = 0; i < replay.objects.size(); ++i) {
    known[replay.objects[i].name] = run.parameters[i];
  }
  if (!replay.run_folder) {
    const Expected<void> kept = write_kept(replay, folder);
    if (!kept) return kept;
  }
  const auto phases = write_file(folder / "phases.csv", format_phases(replay));
  if (!phases) return phases;
  return write_file(folder / "parameters.yaml",
                    format_parameters(known, "parameters at the end of a replay"));
}

void emit_teleop(const Replay& replay, YAML::Emitter& yaml) {
  const TeleopRun& run = *replay.teleop;
  const TeleopOptions& options = replay.teleop_options;
  yaml << YAML::Key << "parameters" << YAML::Value << as_utf8_text(replay.parameters_file);
  yaml << YAML::Key << "forward_delay" << YAML::Value << options.forward_delay;
  yaml << YAML::Key << "backward_delay" << YAML::Value << options.backward_delay;
  yaml << YAML::Key << "jitter" << YAML::Value << options.jitter;
  yaml << YAML::Key << "loss" << YAML::Value << options.loss;
  yaml << YAML::Key << "seed" << YAML::Value << options.seed;
  yaml << YAML::Key << "corrections" << YAML::Value << options.with_corrections;
  yaml << YAML::Key << "identifies" << YAML::Value << options.identifies;
  yaml << YAML::Key << "time_offset" << YAML::Value << YAML::BeginMap;
  emit_offset(run.inputs.tool_to_force, "tool_to_force", yaml);
  emit_offset(run.inputs.tool_to_camera, "tool_to_camera", yaml);
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
