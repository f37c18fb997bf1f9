// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/recording/time_series.hpp"

#include "arm_contacts.hpp"
#include "contact_task.hpp"
#include "evaluated_recording.hpp"
#include "findings.hpp"
#include "run_findings.hpp"

namespace pcavr {
namespace {

/// The last instant of an object in the run: its last pose, force or change of phase.
Stamp end_of(const std::string& object, const RunFiles& files, const ComparisonSide& subject) {
  Stamp end;
  bool has_stamp = false;
  const auto include = [&](Stamp stamp) {
    end = has_stamp ? std::max(end, stamp) : stamp;
    has_stamp = true;
  };
  for (const auto* trajectories : {&subject.tracked, &subject.predicted}) {
    const auto found = trajectories->find(object);
    if (found != trajectories->end()) include(found->second.poses().back().stamp);
  }
  for (const auto* timelines : {&files.measured, &files.predicted}) {
    const auto found = timelines->find(object);
    if (found != timelines->end()) include(found->second.back().stamp);
  }
  const auto forces = files.forces.find(object);
  if (forces != files.forces.end()) include(forces->second.back().stamp);
  return end;
}

void compare_phases(const std::map<std::string, PhaseTimeline>& reference,
                    const std::map<std::string, PhaseTimeline>& estimate, const RunFiles& files,
                    const ComparisonSide& subject, PhaseComparison comparison,
                    RunFindings& findings) {
  for (const auto& [object, timeline] : estimate) {
    const auto reference_timeline = reference.find(object);
    if (reference_timeline == reference.end()) continue;
    comparison.objects[object] =
        phase_errors(reference_timeline->second, timeline, end_of(object, files, subject));
  }
  if (!comparison.objects.empty()) findings.phase_comparisons.push_back(std::move(comparison));
}

/// When the node's event occurs in the run.
std::optional<Stamp> match_of(const TimeNode& node, const RunFindings& findings,
                              const std::string& comparison_key) {
  for (const PhaseComparison& comparison : findings.phase_comparisons) {
    const auto object = comparison.objects.find(node.object);
    if (comparison.key != comparison_key || object == comparison.objects.end()) continue;
    for (const MatchedEvent& event : object->second.events) {
      if (event.reference.stamp == node.event.stamp && event.reference.event == node.event.event) {
        return event.estimate;
      }
    }
  }
  return std::nullopt;
}

void find_nodes(RunFindings& findings) {
  const bool has_truth = !findings.true_phases.empty();
  for (const TimeNode& node : time_nodes(findings.phases())) {
    NodeFindings found{.node = node};
    found.measured =
        has_truth ? match_of(node, findings, "measured") : std::optional(node.event.stamp);
    found.predicted = match_of(node, findings, has_truth ? "predicted" : "predicted_to_measured");
    findings.nodes.push_back(std::move(found));
  }
}

CorrectionFindings evaluate_corrections(const std::vector<RunCorrection>& corrections,
                                        Duration round_trip,
                                        const std::vector<ObjectFindings>& objects) {
  CorrectionFindings found{.counts = count_corrections(corrections)};
  found.effects.resize(corrections.size());
  for (const ObjectFindings& object : objects) {
    if (object.source != "predicted") continue;
    const std::vector<PoseError>& errors = object.errors.absolute;
    found.settling[object.name] = settling_of(object.name, corrections, errors, round_trip);
    for (std::size_t i = 0; i < corrections.size(); ++i) {
      if (corrections[i].object == object.name)
        found.effects[i] = effect_of(corrections[i], errors);
    }
  }
  return found;
}

/// The tool's motion, if the run's recording is available and has it.
Expected<Trajectory> read_tool(const std::filesystem::path& recording) {
  std::error_code ignored;
  const std::filesystem::path file = recording / "tool.csv";
  if (recording.empty() || !std::filesystem::exists(file, ignored)) return Trajectory();
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  // Bad rows are skipped, as a replay may do; no metric depends on them.
  Expected<Series<Trajectory>> tool =
      parse_tool({.file = file.string(), .text = *text, .skip_bad = true});
  if (!tool) return tool.error();
  return std::move(tool).value().content;
}

/// Speed and task of each contact, by the tool's motion.
void add_contact_motion(const Trajectory& T_base_tool, const EvaluatedRecording& recording,
                        const std::vector<ObjectFindings>& objects,
                        const ForceErrorOptions& options, RunFindings& run) {
  for (auto& [name, peaks] : run.peaks) {
    const PhaseTimeline phases = run.phases_of(name);
    ContactTaskInput motion{.T_base_tool = T_base_tool, .phases = phases};
    for (const ObjectFindings& object : objects) {
      if (object.name == name) motion.T_base_object = &object.reference;
    }
    const auto mesh = recording.meshes_object.find(name);
    if (mesh != recording.meshes_object.end()) motion.closed_mesh_object = &mesh->second;
    for (ContactPeak& peak : peaks) {
      peak.approach_speed = approach_speed(T_base_tool, peak.begin, options);
      peak.travel = travel_to_peak(T_base_tool, peak);
      peak.task = task_of(peak, motion, options);
    }
  }
}

std::vector<ForceSample> samples_from(const std::vector<ForceSample>& samples, Stamp from) {
  const auto first = std::find_if(samples.begin(), samples.end(),
                                  [from](const ForceSample& one) { return one.stamp >= from; });
  return {first, samples.end()};
}

}  // namespace

PhaseTimeline RunFindings::phases_of(const std::string& object) const {
  const auto found = phases().find(object);
  return found == phases().end() ? PhaseTimeline() : found->second;
}

RunFindings compare_run(RunFiles files, std::map<std::string, PhaseTimeline> true_phases,
                        const ComparisonSide& subject, const std::vector<ObjectFindings>& objects,
                        const ForceErrorOptions& options) {
  RunFindings findings;
  findings.files = std::move(files);
  findings.true_phases = std::move(true_phases);
  const RunFiles& run = findings.files;
  findings.round_trip = std::chrono::duration_cast<Duration>(std::chrono::duration<double>(
      run.settings.forward_delay.value_or(0.0) + run.settings.backward_delay.value_or(0.0)));

  compare_phases(findings.true_phases, run.measured, run, subject,
                 {.key = "measured", .estimate = "measured", .reference = "truth"}, findings);
  compare_phases(findings.true_phases, run.predicted, run, subject,
                 {.key = "predicted", .estimate = "predicted", .reference = "truth"}, findings);
  compare_phases(run.measured, run.predicted, run, subject,
                 {.key = "predicted_to_measured", .estimate = "predicted", .reference = "measured"},
                 findings);
  find_nodes(findings);
  for (const auto& [object, samples] : run.forces) {
    const PhaseTimeline phases = findings.phases_of(object);
    findings.forces[object] = force_errors(samples, phases, options);
    const std::optional<Stamp> arrival =
        run.corrections ? first_parameters(object, *run.corrections, findings.round_trip)
                        : std::nullopt;
    if (arrival) {
      findings.forces_with_parameters[object] =
          force_errors(samples_from(samples, *arrival), phases, options);
    }
    findings.peaks[object] = contact_peaks(samples, options);
  }
  if (run.corrections) {
    findings.corrections = evaluate_corrections(*run.corrections, findings.round_trip, objects);
  }
  return findings;
}

Expected<void> add_run(const ComparisonSide& reference, const ComparisonSide& subject,
                       const EvaluatedRecording& recording, const ForceErrorOptions& options,
                       Findings& findings) {
  if (subject.kind != SideKind::run) return {};
  Expected<RunFiles> files = read_run_files(subject.folder);
  if (!files) return files.error();
  TruthFiles truth;
  if (reference.kind == SideKind::truth) {
    Expected<TruthFiles> read = read_truth_files(reference.folder);
    if (!read) return read.error();
    truth = std::move(read).value();
  }
  if (files->parameters) {
    findings.has_true_parameters = truth.parameters.has_value();
    findings.parameters =
        parameter_errors(truth.parameters.value_or(ParameterTable()), *files->parameters);
  }
  const bool has_tracking_only = files->measured.empty() && files->forces.empty() &&
                                 !files->corrections && subject.predicted.empty();
  if (has_tracking_only) return {};
  findings.run = compare_run(std::move(files).value(), std::move(truth.phases), subject,
                             findings.objects, options);
  const Expected<Trajectory> T_base_tool =
      read_tool((reference.recording.empty() ? subject : reference).recording);
  if (!T_base_tool) return T_base_tool.error();
  add_contact_motion(*T_base_tool, recording, findings.objects, options, *findings.run);
  return add_joint_loads((reference.recording.empty() ? subject : reference).recording, options,
                         *findings.run);
}

}  // namespace pcavr
