// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "html_text.hpp"
#include "report.hpp"

namespace pcavr {
namespace {

// Series colours: Okabe & Ito's palette, which readers with any kind of colour vision can tell
// apart; lighter ones of the same hues on dark.
constexpr const char* kStyle = R"(
:root { color-scheme: light dark; --ink: #1c2126; --soft: #5b6570; --paper: #ffffff;
  --panel: #f5f7f9; --rule: #d7dde3; --band: #f3dfb4; --c0: #0072b2; --c1: #d55e00;
  --c2: #009e73; --c3: #aa4499; }
@media (prefers-color-scheme: dark) { :root { --ink: #e8ebee; --soft: #a2adb8; --paper: #14181c;
  --panel: #1d2329; --rule: #39424b; --band: #4a4022; --c0: #56b4e9; --c1: #f0905a;
  --c2: #3cc8a0; --c3: #dd99cc; } }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 1180px; padding: 24px 20px 48px; color: var(--ink);
  background: var(--paper); font: 15px/1.5 system-ui, "Segoe UI", "DejaVu Sans", sans-serif; }
h1 { font-size: 26px; margin: 0 0 4px; }
h2 { font-size: 19px; margin: 36px 0 10px; }
.inputs { color: var(--soft); margin: 0; overflow-wrap: anywhere; }
.inputs b { color: var(--ink); font-weight: 600; }
.note { border-left: 4px solid var(--c1); padding: 4px 12px; background: var(--panel); }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: 4px 12px 4px 0; border-bottom: 1px solid var(--rule); text-align: right;
  white-space: nowrap; }
th { color: var(--soft); font-weight: 600; }
th:first-child, td:first-child { text-align: left; }
.headline { margin-top: 16px; }
.headline td:nth-child(2) { font-weight: 650; font-size: 17px; padding-left: 20px;
  padding-right: 6px; }
.headline td:nth-child(3), .headline th:nth-child(3) { text-align: left; color: var(--soft); }
.plots { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 480px), 1fr));
  gap: 18px; align-items: start; }
figure { margin: 0; padding: 12px 14px 8px; background: var(--panel); border-radius: 8px;
  break-inside: avoid; }
figure.map { grid-row: span 2; }
.plots + .scroll { margin-top: 14px; }
figcaption { font-weight: 600; }
.legend { margin: 2px 0 4px; color: var(--soft); font-size: 13px; display: flex; flex-wrap: wrap;
  gap: 2px 16px; }
.legend span { display: inline-flex; align-items: center; gap: 6px; }
.key { width: 24px; height: 8px; }
.plot { width: 100%; height: auto; display: block; }
.plot text { fill: var(--soft); font-size: 12px; }
.plot .label { fill: var(--ink); font-size: 13px; }
.middle { text-anchor: middle; }
.end { text-anchor: end; }
.grid { stroke: var(--rule); stroke-width: 1; }
.frame { fill: none; stroke: var(--soft); stroke-width: 1; }
.mark { stroke: var(--soft); stroke-width: 1; stroke-dasharray: 2 3; }
.band { fill: var(--band); }
path { fill: none; stroke-width: 1.8; stroke-linejoin: round; stroke-linecap: round; }
.dashed { stroke-dasharray: 6 5; }
.s0 { stroke: var(--c0); } .s1 { stroke: var(--c1); }
.s2 { stroke: var(--c2); } .s3 { stroke: var(--c3); }
footer { margin-top: 36px; color: var(--soft); font-size: 13px; }
@media print { body { max-width: none; padding: 0; } }
)";

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
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>Position errors: " +
      escaped(report.subject) + "</title>\n<style>" + kStyle + "</style>\n</head>\n<body>\n";
  html += format_header(report, findings) + format_headline(report);
  for (const ReportSection& section : report.sections) html += format_section(section);
  html += format_placements(findings.placements);
  html +=
      "<footer>Absolute and relative errors as evo defines them; alignment is rigid, without "
      "scale. std is of the population. ADD and MSSD: mean and largest distance of the model's "
      "vertices, without symmetries. The same figures in SI units are in report.json. pcavr " +
      escaped(PCAVR_VERSION) + "</footer>\n</body>\n</html>\n";
  return html;
}

}  // namespace pcavr
