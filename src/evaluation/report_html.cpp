// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <span>

#include "pcavr/evaluation/html_page.hpp"
#include "pcavr/evaluation/html_text.hpp"

#include "report.hpp"

namespace pcavr {
namespace {

/// From SI to the tables' units: millimetres, degrees, milliseconds, per cent.
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

std::string cell(const std::string& content) { return "<td>" + escaped(content) + "</td>"; }

std::string format_metrics(std::span<const Metric> metrics) {
  std::string html =
      "<table class=\"headline\">\n<thead><tr><th>metric</th><th>value</th><th>unit</th></tr>"
      "</thead>\n<tbody>\n";
  for (const Metric& metric : metrics) {
    const bool is_count = metric.unit.empty();
    html += "<tr>" + cell(metric.name) +
            cell(is_count ? fixed(metric.value, 0) : readable(metric.value)) + cell(metric.unit) +
            "</tr>\n";
  }
  return html + "</tbody>\n</table>\n";
}

/// A long list in two columns.
std::string format_headline(const Report& report) {
  constexpr std::size_t kMaxColumn = 14;
  const std::span<const Metric> all = report.headline;
  if (all.size() <= kMaxColumn) return format_metrics(all);
  const std::size_t half = (all.size() + 1) / 2;
  return "<div class=\"two\">\n" + format_metrics(all.first(half)) +
         format_metrics(all.subspan(half)) + "</div>\n";
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

std::string format_row(const ErrorRow& row, bool is_brief) {
  const DisplayUnit unit = display_unit(row.unit);
  std::string html = "<tr>" + cell(row.name) + cell(unit.name);
  for (const ErrorColumn& column : kErrorColumns) {
    if (is_brief && !column.is_brief) continue;
    const bool is_squared = column.value == &ErrorStatistics::sse;
    const double scale = is_squared ? unit.scale * unit.scale : unit.scale;
    html += cell(row.stats.count > 0 ? readable(row.stats.*column.value * scale) : "-");
  }
  return html + cell(std::to_string(row.stats.count)) + "</tr>\n";
}

std::string format_rows(const ReportSection& section) {
  if (section.rows.empty()) return {};
  std::string html = "<div class=\"scroll\"><table>\n<thead><tr><th>error</th><th>unit</th>";
  for (const ErrorColumn& column : kErrorColumns) {
    if (!section.is_brief || column.is_brief) html += "<th>" + std::string(column.name) + "</th>";
  }
  html += "<th>count</th></tr></thead>\n<tbody>\n";
  for (const ErrorRow& row : section.rows) html += format_row(row, section.is_brief);
  return html + "</tbody>\n</table></div>\n";
}

/// Texts are aligned to the left, numbers to the right.
bool is_text_table(const ReportTable& table) {
  constexpr std::size_t kMaxNumber = 24;
  for (const std::vector<std::string>& row : table.rows) {
    if (row.back().size() > kMaxNumber) return true;
  }
  return false;
}

std::string format_table(const ReportTable& table) {
  std::string html = table.is_folded ? "<details><summary>" + escaped(table.title) + "</summary>\n"
                                     : "<div><h3>" + escaped(table.title) + "</h3>\n";
  html += "<div class=\"scroll\"><table" +
          std::string(is_text_table(table) ? " class=\"words\"" : "") + ">\n<thead><tr>";
  for (const std::string& column : table.columns) html += "<th>" + escaped(column) + "</th>";
  html += "</tr></thead>\n<tbody>\n";
  for (const std::vector<std::string>& row : table.rows) {
    html += "<tr>";
    for (const std::string& content : row) html += cell(content);
    html += "</tr>\n";
  }
  html += "</tbody>\n</table></div>\n";
  if (!table.note.empty()) html += "<p class=\"below\">" + escaped(table.note) + "</p>\n";
  return html + (table.is_folded ? "</details>\n" : "</div>\n");
}

std::string format_section(const ReportSection& section) {
  std::string html = "<h2>" + escaped(section.title) + "</h2>\n";
  if (!section.note.empty()) html += "<p class=\"below\">" + escaped(section.note) + "</p>\n";
  html += format_lanes(section.lanes);
  if (!section.plots.empty()) {
    html += "<div class=\"plots\">\n";
    for (const Plot& plot : section.plots) html += format_figure(plot);
    html += "</div>\n";
  }
  html += "<div class=\"tables\">\n" + format_rows(section);
  for (const ReportTable& table : section.tables) html += format_table(table);
  return html + "</div>\n";
}

std::string format_placements(const std::vector<PlacementFindings>& placements) {
  if (placements.empty()) return {};
  std::string html =
      "<h2>Objects in the scene</h2>\n<div class=\"scroll\"><table>\n<thead><tr><th>object</th>"
      "<th>when</th><th>position (mm)</th><th>rotation (deg)</th><th>ADD (mm)</th>"
      "<th>MSSD (mm)</th></tr></thead>\n<tbody>\n";
  for (const PlacementFindings& placed : placements) {
    const DisplayUnit angle = display_unit("rad");
    html += "<tr>" + cell(placed.name) + cell(placed.when) +
            cell(readable(placed.translation * 1e3)) +
            cell(readable(placed.rotation * angle.scale)) +
            cell(placed.model ? readable(placed.model->add * 1e3) : "-") +
            cell(placed.model ? readable(placed.model->mssd * 1e3) : "-") + "</tr>\n";
  }
  return html + "</tbody>\n</table></div>\n";
}

std::string title_of(const Findings& findings) {
  return findings.run ? "Run evaluation" : "Position errors";
}

std::string format_header(const Report& report, const Findings& findings) {
  std::string html = "<h1>" + title_of(findings) + "</h1>\n<p class=\"inputs\">" +
                     escaped(report.subject_kind) + " <b>" + escaped(report.subject) +
                     "</b><br>\ncompared with the " + escaped(report.reference_kind) + " <b>" +
                     escaped(report.reference) + "</b>";
  if (!report.recording.empty()) {
    html += "<br>\nof the recording <b>" + escaped(report.recording) + "</b>";
  }
  html += "</p>\n";
  for (const std::string& name : findings.objects_missing) {
    html += "<p class=\"note\">" + escaped(name) + " has no pose in this " +
            escaped(report.subject_kind) + ".</p>\n";
  }
  return html;
}

}  // namespace

std::string format_html(const Report& report, const Findings& findings) {
  std::string html = format_header(report, findings) + format_headline(report);
  for (const ReportSection& section : report.sections) html += format_section(section);
  html += format_placements(findings.placements);
  html +=
      "<footer>Absolute and relative errors as evo defines them; alignment is rigid, without "
      "scale. std is of the population; p95 is the 95th percentile. ADD and MSSD: mean and maximum "
      "distance of the model's vertices, without symmetries. The same values in SI units are in "
      "report.json. pcavr " +
      escaped(PCAVR_VERSION) + "</footer>\n";
  return html_page(title_of(findings) + ": " + report.subject, html);
}

}  // namespace pcavr
