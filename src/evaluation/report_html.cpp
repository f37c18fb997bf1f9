// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "html_page.hpp"
#include "html_text.hpp"
#include "report.hpp"

namespace pcavr {
namespace {

/// SI to what the tables show: millimetres and degrees.
struct ShownUnit {
  const char* name;
  double scale;
};

ShownUnit shown_unit(const std::string& si_unit) {
  constexpr double kDegrees = 57.29577951308232;
  return si_unit == "rad" ? ShownUnit{"deg", kDegrees} : ShownUnit{"mm", 1e3};
}

std::string cell(const std::string& content) { return "<td>" + escaped(content) + "</td>"; }

std::string format_headline(const Report& report) {
  std::string html =
      "<table class=\"headline\">\n<thead><tr><th>figure</th><th>value</th><th>unit</th></tr>"
      "</thead>\n<tbody>\n";
  for (const Figure& figure : report.headline) {
    const bool is_count = figure.unit.empty();
    html += "<tr>" + cell(figure.name) +
            cell(is_count ? fixed(figure.value, 0) : readable(figure.value)) + cell(figure.unit) +
            "</tr>\n";
  }
  return html + "</tbody>\n</table>\n";
}

std::string format_row(const ErrorRow& row) {
  const ShownUnit unit = shown_unit(row.unit);
  const ErrorStatistics& figures = row.figures;
  std::string html = "<tr>" + cell(row.name) + cell(unit.name);
  // The order in which evo prints them.
  for (const double value : {figures.max, figures.mean, figures.median, figures.min, figures.rmse,
                             figures.sse * unit.scale, figures.std, figures.p95}) {
    html += cell(readable(value * unit.scale));
  }
  return html + cell(std::to_string(figures.count)) + "</tr>\n";
}

std::string format_section(const ReportSection& section) {
  std::string html = "<h2>" + escaped(section.title) + "</h2>\n<div class=\"plots\">\n";
  for (const Plot& plot : section.plots) html += format_figure(plot);
  html += "</div>\n<div class=\"scroll\"><table>\n<thead><tr><th>error</th><th>unit</th>";
  for (const char* column :
       {"max", "mean", "median", "min", "rmse", "sse (unit²)", "std", "95 %", "count"}) {
    html += "<th>" + std::string(column) + "</th>";
  }
  html += "</tr></thead>\n<tbody>\n";
  for (const ErrorRow& row : section.rows) html += format_row(row);
  return html + "</tbody>\n</table></div>\n";
}

std::string format_placements(const std::vector<PlacementFindings>& placements) {
  if (placements.empty()) return {};
  std::string html =
      "<h2>Objects in the scene</h2>\n<div class=\"scroll\"><table>\n<thead><tr><th>object</th>"
      "<th>when</th><th>position (mm)</th><th>rotation (deg)</th><th>ADD (mm)</th>"
      "<th>MSSD (mm)</th></tr></thead>\n<tbody>\n";
  for (const PlacementFindings& placed : placements) {
    const ShownUnit angle = shown_unit("rad");
    html += "<tr>" + cell(placed.name) + cell(placed.when) +
            cell(readable(placed.translation * 1e3)) +
            cell(readable(placed.rotation * angle.scale)) +
            cell(placed.model ? readable(placed.model->add * 1e3) : "-") +
            cell(placed.model ? readable(placed.model->mssd * 1e3) : "-") + "</tr>\n";
  }
  return html + "</tbody>\n</table></div>\n";
}

std::string format_header(const Report& report, const Findings& findings) {
  std::string html = "<h1>Position errors</h1>\n<p class=\"inputs\">" +
                     escaped(report.subject_kind) + " <b>" + escaped(report.subject) +
                     "</b><br>\nheld against the " + escaped(report.reference_kind) + " <b>" +
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
      "scale. std is of the population. ADD and MSSD: mean and largest distance of the model's "
      "vertices, without symmetries. The same figures in SI units are in report.json. pcavr " +
      escaped(PCAVR_VERSION) + "</footer>\n";
  return html_page("Position errors: " + report.subject, html);
}

}  // namespace pcavr
