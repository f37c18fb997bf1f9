// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "pcavr/base/report/number_text.hpp"

#include "phase_timeline.hpp"
#include "report.hpp"
#include "verdict.hpp"

namespace pcavr {
namespace {

/// Conversion from SI to the tables' units: millimetres, degrees, milliseconds, per cent.
struct DisplayUnit {
  const char* name;
  double scale;
};

DisplayUnit display_unit(const std::string& si_unit) {
  if (si_unit == "rad") return {"deg", kDegrees};
  if (si_unit == "s") return {"ms", 1e3};
  if (si_unit == "N") return {"N", 1.0};
  if (si_unit.empty()) return {"%", kPercent};
  return {"mm", kMillimetres};
}

ReportTable headline_table(const Report& report) {
  ReportTable table{.title = "", .columns = {"metric", "value", "unit"}};
  for (const Metric& metric : report.headline) {
    const bool is_count = metric.unit.empty();
    table.rows.push_back(
        {metric.name, is_count ? fixed(metric.value, 0) : readable(metric.value), metric.unit});
  }
  return table;
}

/// A column of a table of errors, in the order in which evo prints them.
struct ErrorColumn {
  const char* name;
  double ErrorStatistics::*value;
  bool is_brief;
};
constexpr std::array<ErrorColumn, 8> kErrorColumns = {
    {{"max", &ErrorStatistics::max, true},
     {"mean", &ErrorStatistics::mean, false},
     {"median", &ErrorStatistics::median, true},
     {"min", &ErrorStatistics::min, false},
     {"rmse", &ErrorStatistics::rmse, true},
     {"sse (unit²)", &ErrorStatistics::sse, false},
     {"std", &ErrorStatistics::std, false},
     {"p95", &ErrorStatistics::p95, true}}};

std::vector<std::string> error_cells(const ErrorRow& row, bool is_brief) {
  const DisplayUnit unit = display_unit(row.unit);
  std::vector<std::string> cells{row.name, unit.name};
  for (const ErrorColumn& column : kErrorColumns) {
    if (is_brief && !column.is_brief) continue;
    const bool is_squared = column.value == &ErrorStatistics::sse;
    const double scale = is_squared ? unit.scale * unit.scale : unit.scale;
    cells.push_back(row.stats.count > 0 ? readable(row.stats.*column.value * scale) : "-");
  }
  cells.push_back(std::to_string(row.stats.count));
  return cells;
}

ReportTable error_table(const ReportSection& section) {
  ReportTable table{.title = "Errors", .columns = {"error", "unit"}};
  for (const ErrorColumn& column : kErrorColumns) {
    if (!section.is_brief || column.is_brief) table.columns.emplace_back(column.name);
  }
  table.columns.emplace_back("count");
  for (const ErrorRow& row : section.rows) {
    table.rows.push_back(error_cells(row, section.is_brief));
  }
  return table;
}

LaneChart phase_chart(const std::vector<Lane>& lanes) {
  LaneChart chart{.title = "Phases over time", .x_label = "time (s)", .lanes = lanes};
  for (const Phase phase : kPhases) chart.kind_labels.emplace_back(to_string(phase));
  return chart;
}

PageSection page_section(const ReportSection& section) {
  PageSection page{.title = section.title};
  if (!section.note.empty()) page.blocks.emplace_back(PageText{section.note});
  for (const PagePicture& picture : section.pictures) page.blocks.emplace_back(picture);
  if (!section.lanes.empty()) page.blocks.emplace_back(phase_chart(section.lanes));
  if (!section.plots.empty()) page.blocks.emplace_back(PlotGroup{"", section.plots});
  std::vector<ReportTable> tables;
  if (!section.rows.empty()) tables.push_back(error_table(section));
  tables.insert(tables.end(), section.tables.begin(), section.tables.end());
  if (!tables.empty()) page.blocks.emplace_back(std::move(tables));
  return page;
}

PageSection placement_section(const std::vector<PlacementFindings>& placements) {
  ReportTable table{
      .title = "Errors of the poses",
      .columns = {"object", "when", "position (mm)", "rotation (deg)", "ADD (mm)", "MSSD (mm)"}};
  for (const PlacementFindings& placed : placements) {
    table.rows.push_back({placed.name, placed.when, readable(placed.translation * kMillimetres),
                          readable(placed.rotation * kDegrees),
                          placed.model ? readable(placed.model->add * kMillimetres) : "-",
                          placed.model ? readable(placed.model->mssd * kMillimetres) : "-"});
  }
  return {.title = "Objects in the scene", .blocks = {std::vector{std::move(table)}}};
}

void add_inputs(const Report& report, ReportPage& page) {
  page.inputs = {{{report.subject_kind + " "}, {report.subject, true}},
                 {{"compared with the " + report.reference_kind + " "}, {report.reference, true}}};
  if (report.recording.empty()) return;
  page.inputs.push_back({{"of the recording "}, {report.recording, true}});
}

}  // namespace

ReportPage evaluation_page(const Report& report, const Findings& findings) {
  ReportPage page;
  const bool is_of_parameters = !findings.run && !findings.parameters.empty();
  page.heading = is_of_parameters ? "Errors of identified parameters"
                 : findings.run   ? "Run evaluation"
                                  : "Position errors";
  page.title = page.heading + ": " + report.subject;
  add_inputs(report, page);
  for (const std::string& name : findings.objects_missing) {
    page.notes.push_back(name + " has no pose in this " + report.subject_kind + ".");
  }
  page.verdict = verdict_of(findings);
  page.headline = headline_table(report);
  for (const ReportSection& section : report.sections) {
    page.sections.push_back(page_section(section));
  }
  if (!findings.placements.empty()) {
    page.sections.push_back(placement_section(findings.placements));
  }
  if (!is_of_parameters) {
    page.footer =
        "Absolute and relative errors as evo defines them; alignment is rigid, without scale. std "
        "is of the population; p95 is the 95th percentile. ADD and MSSD: mean and maximum distance "
        "of the model's vertices, without symmetries. ";
  }
  page.footer += "The same values in SI units are in report.json. pcavr " PCAVR_VERSION;
  return page;
}

}  // namespace pcavr
