// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/report/number_text.hpp"

#include "run_report.hpp"

namespace pcavr {
namespace {

ReportTable count_table(const std::string& title, const std::string& column,
                        const std::map<std::string, std::size_t>& counts) {
  ReportTable table{.title = title, .columns = {column, "corrections"}};
  for (const auto& [name, count] : counts) table.rows.push_back({name, std::to_string(count)});
  return table;
}

ReportTable settling_table(const CorrectionFindings& found) {
  ReportTable table{
      .title = "Convergence of the prediction",
      .columns = {"object", "error at first pose", "corrections until below 3 mm",
                  "time until below 3 mm (s)", "corrections until settled below 3 mm"}};
  const auto count = [](const std::optional<std::size_t>& value) {
    return value ? std::to_string(*value) : "never";
  };
  for (const auto& [object, settling] : found.settling) {
    table.rows.push_back(
        {object, settling.starts_in_tolerance ? "below 3 mm" : "above 3 mm",
         count(settling.corrections_to_tolerance),
         settling.seconds_to_tolerance ? fixed(*settling.seconds_to_tolerance, 3) : "never",
         count(settling.corrections_until_settled)});
  }
  table.note =
      "A correction counts from its arrival, one round trip after the time that it corrects.";
  return table;
}

/// Recovery times [s] of corrections that were sent while the error was above 3 mm, and not lost.
std::vector<double> recovery_times(const RunFindings& run) {
  std::vector<double> seconds;
  for (std::size_t i = 0; i < run.corrections->effects.size(); ++i) {
    const CorrectionEffect& effect = run.corrections->effects[i];
    const bool was_outside = effect.initial_error && *effect.initial_error >= kPositionTolerance;
    if (!was_outside || (*run.files.corrections)[i].is_lost) continue;
    if (effect.seconds_to_tolerance) seconds.push_back(*effect.seconds_to_tolerance);
  }
  return seconds;
}

std::size_t count_never_in_tolerance(const RunFindings& run) {
  std::size_t count = 0;
  for (const CorrectionEffect& effect : run.corrections->effects) {
    count += effect.initial_error && !effect.seconds_to_tolerance ? 1 : 0;
  }
  return count;
}

void add_traffic(const RunFindings& run, ReportSection& section) {
  const RunSettings& settings = run.files.settings;
  const auto sent = static_cast<double>(run.corrections->counts.bytes);
  if (!settings.streaming_bytes || *settings.streaming_bytes <= 0.0) return;
  section.values.push_back({"corrections.streaming_bytes", *settings.streaming_bytes});
  section.values.push_back({"corrections.bytes_saved", *settings.streaming_bytes - sent});
  section.values.push_back({"corrections.share_of_streaming", sent / *settings.streaming_bytes});
}

void add_settling(const CorrectionFindings& found, ReportSection& section) {
  for (const auto& [object, settling] : found.settling) {
    const std::string key = "corrections.object." + object;
    if (settling.corrections_to_tolerance) {
      section.values.push_back({key + ".until_good.count", *settling.corrections_to_tolerance});
      section.values.push_back({key + ".until_good_s", *settling.seconds_to_tolerance});
    }
    if (settling.corrections_until_settled) {
      section.values.push_back({key + ".until_settled.count", *settling.corrections_until_settled});
    }
  }
}

}  // namespace

ReportSection correction_section(const Findings& findings) {
  const RunFindings& run = *findings.run;
  const CorrectionFindings& found = *run.corrections;
  ReportSection section{.title = "Corrections", .key = "corrections", .is_brief = true};
  section.values = {{"corrections.count", found.counts.count},
                    {"corrections.lost", found.counts.lost},
                    {"corrections.bytes", found.counts.bytes}};
  add_traffic(run, section);
  for (const auto& [which, count] : found.counts.by_case) {
    section.values.push_back({"corrections.case." + which, count});
  }
  for (const auto& [what, count] : found.counts.by_what) {
    section.values.push_back({"corrections.what." + what, count});
  }
  section.values.push_back({"corrections.never_good", count_never_in_tolerance(run)});
  add_settling(found, section);
  if (!found.settling.empty()) section.tables.push_back(settling_table(found));
  if (found.counts.count == 0) {
    section.note = "No corrections were sent.";
    return section;
  }
  const std::vector<double> recovery = recovery_times(run);
  if (!recovery.empty()) {
    section.rows.push_back({"recovery time to below 3 mm", "recovery", "s", statistics(recovery)});
  }
  section.tables.push_back(
      count_table("By case of the correction switch", "case", found.counts.by_case));
  section.tables.push_back(count_table("By content", "content", found.counts.by_what));
  section.tables.push_back(correction_table(findings));
  return section;
}

}  // namespace pcavr
