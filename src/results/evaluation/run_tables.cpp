// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "pcavr/base/report/number_text.hpp"

#include "run_report.hpp"

namespace pcavr {
namespace {

constexpr double kMsPerSecond = 1e3;
/// A longer list is not readable; the run's file has it.
constexpr std::size_t kMaxRows = 200;

std::string time_text(std::optional<Stamp> stamp, Stamp origin) {
  return stamp ? fixed(to_seconds(*stamp - origin), 3) : "missed";
}

std::string difference_text(std::optional<Stamp> stamp, Stamp reference) {
  return stamp ? fixed(kMsPerSecond * to_seconds(*stamp - reference), 0) : "-";
}

std::string joined(const std::vector<std::string>& words, const std::string& separator) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : separator) + word;
  return text;
}

std::string yes_or_no(bool value) { return value ? "yes" : "no"; }

}  // namespace

ReportTable settings_table(const RunFindings& run) {
  const RunSettings& settings = run.files.settings;
  ReportTable table{.title = "Run settings", .columns = {"setting", "value"}};
  const auto add = [&](const std::string& name, const std::string& value) {
    table.rows.push_back({name, value});
  };
  const auto add_delay = [&](const std::string& name, const std::optional<double>& seconds) {
    if (seconds) add(name, readable(kMsPerSecond * *seconds) + " ms");
  };
  add_delay("delay from operator to robot", settings.forward_delay);
  add_delay("delay from robot to operator", settings.backward_delay);
  add_delay("jitter of either delay (std)", settings.jitter);
  if (settings.loss)
    add("corrections lost by the network", readable(kPercent * *settings.loss) + " %");
  if (settings.parameters) add("initial parameters", *settings.parameters);
  if (settings.identifies) add("online identification", yes_or_no(*settings.identifies));
  if (settings.corrections) add("corrections", yes_or_no(*settings.corrections));
  for (const auto& [object, assumed] : settings.assumed) {
    if (!assumed.empty()) add("default parameters of " + object, joined(assumed, ", "));
  }
  for (const std::string& note : settings.notes) add("note", note);
  return table;
}

ReportTable node_table(const Findings& findings) {
  const RunFindings& run = *findings.run;
  const bool has_truth = !run.true_phases.empty();
  ReportTable table{.title = "Time nodes", .columns = {"node", "object", "event"}};
  if (has_truth)
    table.columns.insert(table.columns.end(), {"truth (s)", "measured (s)", "error (ms)"});
  if (!has_truth) table.columns.push_back("measured (s)");
  table.columns.insert(table.columns.end(), {"predicted (s)", "error (ms)"});
  for (const NodeFindings& found : run.nodes) {
    const Stamp reference = found.node.event.stamp;
    std::vector<std::string> row = {"t" + std::to_string(found.node.number), found.node.object,
                                    std::string(to_string(found.node.event.event)),
                                    time_text(reference, findings.origin)};
    if (has_truth) {
      row.push_back(time_text(found.measured, findings.origin));
      row.push_back(difference_text(found.measured, reference));
    }
    row.push_back(time_text(found.predicted, findings.origin));
    row.push_back(difference_text(found.predicted, reference));
    table.rows.push_back(std::move(row));
  }
  table.note =
      "Of each push: the contact, the first time at the friction limit, the first slide, the last "
      "stop and the end of the contact, numbered as in paper C's figure 11. Missed: no event of "
      "that kind within 0.5 s.";
  table.is_folded = table.rows.size() > 20;
  return table;
}

ReportTable confusion_table(const PhaseComparison& comparison) {
  std::vector<PhaseErrors> all;
  for (const auto& [object, errors] : comparison.objects) all.push_back(errors);
  const PhaseErrors sum = merged(all);
  ReportTable table{.title = "Confusion matrix of the phases",
                    .columns = {comparison.reference + " phase", "time (s)"}};
  for (const Phase phase : kPhases) {
    table.columns.push_back(std::string(to_string(phase)) + " (%)");
  }
  for (std::size_t row = 0; row < kPhaseCount; ++row) {
    double total = 0.0;
    for (const double seconds : sum.seconds.at(row)) total += seconds;
    std::vector<std::string> cells = {std::string(to_string(kPhases.at(row))), fixed(total, 2)};
    for (const double seconds : sum.seconds.at(row)) {
      cells.push_back(total > 0.0 ? fixed(kPercent * seconds / total, 1) : "-");
    }
    table.rows.push_back(std::move(cells));
  }
  table.note = "Columns: the " + comparison.estimate + " phase, in % of the row's time.";
  return table;
}

ReportTable correction_table(const Findings& findings) {
  const RunFindings& run = *findings.run;
  const std::vector<RunCorrection>& corrections = *run.files.corrections;
  ReportTable table{.title = "Each correction",
                    .columns = {"corrected time (s)", "object", "case", "content", "bytes",
                                "error at that time (mm)", "below 3 mm after (s)"},
                    .is_folded = true};
  const std::size_t shown = std::min(corrections.size(), kMaxRows);
  for (std::size_t i = 0; i < shown; ++i) {
    const RunCorrection& one = corrections[i];
    const CorrectionEffect& effect = run.corrections->effects[i];
    table.rows.push_back(
        {fixed(to_seconds(one.stamp - findings.origin), 3), one.object, one.which,
         joined(one.what, ", ") + (one.is_lost ? " (lost)" : ""), std::to_string(one.bytes),
         effect.initial_error ? readable(kMillimetres * *effect.initial_error) : "-",
         effect.seconds_to_tolerance ? fixed(*effect.seconds_to_tolerance, 3)
         : effect.initial_error      ? "never"
                                     : "-"});
  }
  if (shown < corrections.size()) {
    table.note = "The first " + std::to_string(shown) + " of " +
                 std::to_string(corrections.size()) + "; corrections.csv has all.";
  }
  return table;
}

}  // namespace pcavr
