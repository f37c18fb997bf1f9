// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "run_report.hpp"

#include "arm_contacts.hpp"
#include "paper_comparison.hpp"
#include "parameter_history.hpp"
#include "pooled_errors.hpp"
#include "run_plots.hpp"

namespace pcavr {
namespace {

void add_pose_rows(const std::string& name, const std::string& key,
                   const std::vector<PoseError>& errors, std::vector<ErrorRow>& rows) {
  if (errors.empty()) return;
  rows.push_back(
      {"position, " + name, key + ".translation", "m", statistics(translations(errors))});
  rows.push_back({"rotation, " + name, key + ".rotation", "rad", statistics(rotations(errors))});
}

/// `select_errors` selects the errors by phase.
template <typename ErrorsWhere>
std::vector<ErrorRow> rows_by_phase(ErrorsWhere select_errors) {
  std::vector<ErrorRow> rows;
  add_pose_rows("in contact or moving", "touched", select_errors(is_touched_or_moving), rows);
  for (const Phase phase : kPhases) {
    const std::string word(to_string(phase));
    add_pose_rows(word, "phase." + word, select_errors([phase](Phase is) { return is == phase; }),
                  rows);
  }
  return rows;
}

std::string phases_note(const RunFindings& run) {
  return "Phases are those of the " +
         std::string(run.true_phases.empty() ? "robot's site, as measured." : "truth.");
}

ReportSection pooled_section(const Findings& findings) {
  ReportSection section{.title = "Position error of the prediction, all objects",
                        .key = "predicted",
                        .note = phases_note(*findings.run),
                        .is_brief = true};
  section.rows = rows_by_phase([&](auto keep) { return predicted_errors_in(findings, keep); });
  add_pose_rows("whole run", "all", predicted_errors(findings), section.rows);
  return section;
}

void add_force_rows(const std::string& name, const std::string& key, const ForceErrorList& errors,
                    std::vector<ErrorRow>& rows) {
  if (errors.difference.empty()) return;
  rows.push_back({"force, " + name, key + ".absolute", "N", statistics(magnitudes(errors))});
  if (errors.relative.empty()) return;
  rows.push_back(
      {"force, " + name + ", relative", key + ".relative", "", statistics(errors.relative)});
}

void add_peaks(const std::vector<ContactPeak>& peaks, ReportSection& section) {
  for (std::size_t i = 0; i < peaks.size(); ++i) {
    const std::string key = section.key + ".contact." + std::to_string(i + 1) + ".";
    section.values.push_back({key + "t_s", peaks[i].begin.seconds()});
    section.values.push_back({key + "largest_measured_N", peaks[i].measured});
    section.values.push_back({key + "largest_felt_N", peaks[i].rendered});
    if (peaks[i].approach_speed) {
      section.values.push_back({key + "approach_speed_m_s", *peaks[i].approach_speed});
    }
  }
}

/// Metrics of the events of one comparison.
void add_phase_values(const std::string& key, const PhaseErrors& errors, ReportSection& section) {
  std::size_t matched = 0;
  for (const MatchedEvent& event : errors.events) matched += event.estimate ? 1 : 0;
  section.values.push_back({key + ".boundary.matched", matched});
  section.values.push_back({key + ".boundary.missed", count_missed(errors)});
  section.values.push_back({key + ".boundary.surplus", count_surplus(errors)});
  section.values.push_back({key + ".agreement", agreement(errors, false)});
  section.values.push_back({key + ".agreement_touched", agreement(errors, true)});
}

void add_confusion_values(const std::string& key, const PhaseErrors& errors,
                          ReportSection& section) {
  for (std::size_t row = 0; row < kPhaseCount; ++row) {
    for (std::size_t column = 0; column < kPhaseCount; ++column) {
      section.values.push_back({key + ".confusion." + std::string(to_string(kPhases.at(row))) +
                                    "." + std::string(to_string(kPhases.at(column))) + "_s",
                                errors.seconds.at(row).at(column)});
    }
  }
}

/// "contact", and how many were missed or surplus.
std::string name_with_counts(const PhaseErrors& errors, PhaseEvent event) {
  std::string name(to_string(event));
  const std::size_t missed = count_missed(errors, event);
  const std::size_t surplus = count_surplus(errors, event);
  if (missed > 0) name += ", " + std::to_string(missed) + " missed";
  if (surplus > 0) name += ", " + std::to_string(surplus) + " surplus";
  return name;
}

ReportSection phase_section(const PhaseComparison& comparison) {
  ReportSection section{
      .title = "Phases " + comparison.estimate + " against " +
               (comparison.reference == "truth" ? "the truth" : "the measured ones"),
      .key = "phases." + comparison.key,
      .is_brief = true};
  std::vector<PhaseErrors> of_objects;
  for (const auto& [object, errors] : comparison.objects) of_objects.push_back(errors);
  const PhaseErrors all = merged(of_objects);
  section.rows.push_back({"boundaries, all", "boundary", "s", statistics(event_errors(all))});
  for (const PhaseEvent event : kEvents) {
    const std::vector<double> seconds = event_errors(all, event);
    if (seconds.empty() && count_missed(all, event) + count_surplus(all, event) == 0) continue;
    const std::string word(to_string(event));
    section.rows.push_back(
        {name_with_counts(all, event), "boundary." + word, "s", statistics(seconds)});
  }
  add_phase_values(section.key, all, section);
  add_confusion_values(section.key, all, section);
  for (const auto& [object, errors] : comparison.objects) {
    const std::string key = section.key + ".object." + object;
    add_phase_values(key, errors, section);
    const ErrorStatistics stats = statistics(event_errors(errors));
    section.values.push_back({key + ".boundary.median_s", stats.median});
    section.values.push_back({key + ".boundary.max_s", stats.max});
  }
  section.tables.push_back(confusion_table(comparison));
  return section;
}

}  // namespace

std::vector<ErrorRow> phase_rows(const std::vector<PoseError>& errors,
                                 const PhaseTimeline& timeline) {
  if (timeline.empty()) return {};
  return rows_by_phase([&](auto keep) { return errors_in(errors, timeline, keep); });
}

ReportSection overview_section(const Findings& findings) {
  const RunFindings& run = *findings.run;
  ReportSection section{.title = "Overview", .key = "run"};
  section.lanes = phase_lanes(findings);
  if (!run.nodes.empty()) section.tables.push_back(node_table(findings));
  ReportTable settings = settings_table(run);
  if (!settings.rows.empty()) section.tables.push_back(std::move(settings));
  for (const NodeFindings& found : run.nodes) {
    const std::string key = "nodes.t" + std::to_string(found.node.number);
    section.values.push_back({key + ".object", found.node.object});
    section.values.push_back({key + ".event", std::string(to_string(found.node.event.event))});
    const auto add = [&](const std::string& name, std::optional<Stamp> stamp) {
      if (stamp) section.values.push_back({key + "." + name + "_s", stamp->seconds()});
    };
    if (!run.true_phases.empty()) add("truth", found.node.event.stamp);
    add("measured", found.measured);
    add("predicted", found.predicted);
  }
  return section;
}

ReportSection push_section(const std::string& name, const ComparisonSide& reference,
                           const ComparisonSide& subject, const Findings& findings) {
  ReportSection section{
      .title = name + ": motion and force", .key = "force." + name, .is_brief = true};
  const ObjectFindings* shown = nullptr;  // the prediction, or else the tracking
  for (const ObjectFindings& object : findings.objects) {
    if (object.name == name && (!shown || object.source == "predicted")) shown = &object;
  }
  if (shown) {
    if (auto plot = motion_plot(*shown, reference, subject, findings)) {
      section.plots.push_back(*std::move(plot));
    } else {
      section.note = name + " stayed within 1 mm of its start.";
    }
  }
  const auto errors = findings.run->forces.find(name);
  if (errors == findings.run->forces.end()) return section;
  section.plots.push_back(force_plot(name, findings));
  add_force_rows("in contact", "in_contact", errors->second.in_contact, section.rows);
  for (const Phase phase : kPhases) {
    const std::string word(to_string(phase));
    add_force_rows(word, word, errors->second.by_phase.at(static_cast<std::size_t>(phase)),
                   section.rows);
  }
  add_force_rows("all", "all", errors->second.all, section.rows);
  section.values.push_back({section.key + ".in_contact.mean_difference_N",
                            statistics(errors->second.in_contact.difference).mean});
  add_peaks(findings.run->peaks.at(name), section);
  return section;
}

std::vector<ReportSection> closing_sections(const Findings& findings) {
  const RunFindings& run = *findings.run;
  std::vector<ReportSection> sections;
  ReportSection pooled = pooled_section(findings);
  if (!pooled.rows.empty()) sections.push_back(std::move(pooled));
  for (const PhaseComparison& comparison : run.phase_comparisons) {
    sections.push_back(phase_section(comparison));
  }
  if (run.corrections) sections.push_back(correction_section(findings));
  for (const auto& [object, history] : run.files.parameter_history) {
    ReportSection section = parameter_history_section(object, findings);
    if (!section.tables.empty()) sections.push_back(std::move(section));
  }
  if (!findings.parameters.empty()) sections.push_back(parameter_section(findings));
  ReportSection papers{.title = "Comparison with the papers", .key = "papers"};
  papers.tables.push_back(paper_table(findings));
  ReportTable contacts = contact_table(findings);
  if (!contacts.rows.empty()) papers.tables.push_back(std::move(contacts));
  for (ReportTable& table : contact_paper_tables(findings)) {
    papers.tables.push_back(std::move(table));
  }
  ReportTable loads = joint_load_table(run, findings.origin);
  if (!loads.rows.empty()) papers.tables.push_back(std::move(loads));
  sections.push_back(std::move(papers));
  return sections;
}

}  // namespace pcavr
