// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>

#include <nlohmann/json.hpp>

#include "pcavr/core/json_text.hpp"
#include "pcavr/core/output.hpp"
#include "pcavr/evaluation/html_page.hpp"
#include "pcavr/evaluation/html_text.hpp"

#include "identify_plots.hpp"

namespace pcavr {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMilliseconds = 1e3;

std::string cell(const std::string& text) { return "<td>" + escaped(text) + "</td>"; }

std::string note(const std::string& text) {
  return "<p class=\"note\">" + escaped(text) + "</p>\n";
}

/// A number of any magnitude: stiffnesses of nonlinear laws may be very large.
std::string figure(double value) {
  if (std::abs(value) < 1e5) return readable(value);
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

std::string findings_table(const ObjectIdentification& object) {
  std::string html =
      "<div class=\"scroll\"><table>\n<thead><tr><th>parameter</th><th>value</th><th>± std</th>"
      "<th>unit</th><th>identified</th><th style=\"text-align:left\">source, or the motion that "
      "would identify it</th></tr></thead>\n<tbody>\n";
  for (const ParameterFinding& row : object.findings) {
    const bool is_known = row.is_excited || row.value != 0.0;
    html += "<tr>" + cell(row.name) + cell(is_known ? figure(row.value) : "-") +
            cell(row.std ? figure(*row.std) : "-") + cell(row.unit) +
            cell(row.is_excited ? "yes" : "no") +
            "<td style=\"text-align:left;white-space:normal\">" + escaped(row.remark) +
            "</td></tr>\n";
  }
  return html + "</tbody>\n</table></div>\n";
}

std::string comparison_table(const ObjectIdentification& object) {
  if (object.comparison.empty()) return {};
  std::string html =
      "<h3>Estimators on the presses</h3>\n<div class=\"scroll\"><table>\n<thead><tr>"
      "<th>method</th><th>settling to 10 % (ms)</th><th>steady error (%)</th><th>mean force error, "
      "tip stationary (%)</th></tr>"
      "</thead>\n"
      "<tbody>\n";
  for (const EstimatorTrace& trace : object.comparison) {
    html += "<tr>" + cell(name_of(trace.method)) +
            cell(trace.settling ? fixed(*trace.settling * kMilliseconds, 0) : "never") +
            cell(readable(trace.steady_error * kPercent)) +
            cell(trace.mean_force_error ? readable(*trace.mean_force_error * kPercent) : "-") +
            "</tr>\n";
  }
  return html + "</tbody>\n</table></div>\n";
}

std::string faces_table(const ObjectIdentification& object) {
  if (object.faces.empty()) return {};
  std::string html =
      "<h3>Faces, from pushes before breakaway</h3>\n<div class=\"scroll\"><table>\n<thead>"
      "<tr><th>normal in the object's axes</th><th>pushes</th><th>stiffness</th><th>damping</th>"
      "<th>exponent</th></tr></thead>\n<tbody>\n";
  for (const FaceContact& face : object.faces) {
    const ContactFit& fit = face.contact.best();
    const Eigen::Vector3d& n = face.normal_object;
    const auto with_std = [](const IdentifiedParameter& p) {
      return figure(p.value) + " ± " + figure(p.std);
    };
    html += "<tr>" + cell(fixed(n.x(), 2) + " " + fixed(n.y(), 2) + " " + fixed(n.z(), 2)) +
            cell(std::to_string(face.pushes));
    html += fit.is_valid
                ? cell(with_std(fit.stiffness)) +
                      cell(fit.damping.is_excited && fit.damping.value > 0.0 ? with_std(fit.damping)
                                                                             : "not identified") +
                      cell(with_std(fit.exponent))
                : cell("-") + cell("-") + cell("-");
    html += "</tr>\n";
  }
  return html + "</tbody>\n</table></div>\n";
}

std::string impacts_table(const ObjectIdentification& object) {
  if (object.impacts.empty()) return {};
  std::string html =
      "<h3>Impacts</h3>\n<div class=\"scroll\"><table>\n<thead><tr><th>time (s)</th>"
      "<th>approach (mm/s)</th><th>restitution</th><th>damping law with the smallest error</th>"
      "<th>damping over stiffness, exact (s/m)</th></tr></thead>\n<tbody>\n";
  for (const MeasuredImpact& impact : object.impacts) {
    html += "<tr>" + cell(fixed(impact.t, 2)) + cell(fixed(impact.approach_speed * 1e3, 0)) +
            cell(fixed(impact.restitution, 2)) + cell(std::string(name_of(impact.law))) +
            cell(readable(impact.damping_over_stiffness)) + "</tr>\n";
  }
  return html + "</tbody>\n</table></div>\n";
}

std::string object_section(const Identification& found, std::size_t index) {
  const ObjectIdentification& object = found.objects[index];
  std::string html = "<h2>" + escaped(object.name) + "</h2>\n";
  for (const std::string& text : object.notes) html += note(text);
  html += findings_table(object) + comparison_table(object) + faces_table(object) +
          impacts_table(object);
  html += "<h3>Plots</h3>\n<div class=\"plots\">\n";
  for (const Plot& plot : contact_plots(object)) html += format_figure(plot);
  if (found.goal == IdentificationGoal::friction) {
    for (const auto& plots :
         {push_plots(found, index), sliding_plots(object), surface_plots(object)}) {
      for (const Plot& plot : plots) html += format_figure(plot);
    }
  }
  return html + "</div>\n";
}

std::string offset_text(const TimeOffset& offset) {
  if (!offset.is_known) return "not known: this recording does not identify it";
  return fixed(offset.offset * kMilliseconds, 2) + " ± " + fixed(offset.std * kMilliseconds, 2) +
         " ms";
}

std::string format_report(const Identification& found, const std::string& recording) {
  const char* goal = found.goal == IdentificationGoal::contact ? "contact" : "contact and friction";
  std::string html =
      "<h1>Identification of " + std::string(goal) + "</h1>\n<p class=\"inputs\">recording <b>" +
      escaped(recording) + "</b><br>\nforce after tool: <b>" + offset_text(found.tool_to_force) +
      "</b>" + (found.is_offset_applied ? ", removed" : "") + "<br>\ntracking after tool: <b>" +
      offset_text(found.tool_to_camera) + "</b><br>\nforce noise <b>" +
      readable(found.force_noise) + " N</b>, bias up to <b>" + readable(found.max_drift) +
      " N</b>, <b>" + std::to_string(found.spikes) + "</b> spikes removed</p>\n";
  for (const std::string& text : found.notes) html += note(text);
  for (std::size_t i = 0; i < found.objects.size(); ++i) html += object_section(found, i);
  html +=
      "<footer>F = stiffness dⁿ + damping dⁿ ḋ (n = 1: damping ḋ). Std: standard "
      "deviation for independent noise, increased for the filters' correlation; it does not cover "
      "model errors. The same figures in SI units are in report.json. pcavr " +
      escaped(PCAVR_VERSION) + "</footer>\n";
  return html_page("Identification: " + recording, html);
}

void add_object(Json& json, const ObjectIdentification& object) {
  const std::string key = "object." + object.name + ".";
  for (const ParameterFinding& row : object.findings) {
    if (row.is_excited || row.value != 0.0) json[key + row.name] = row.value;
    if (row.std && std::isfinite(*row.std)) json[key + row.name + "_std"] = *row.std;
    json[key + row.name + ".is_excited"] = row.is_excited;
    json[key + row.name + ".remark"] = row.remark;
  }
  json[key + "presses"] = object.press_count;
  json[key + "pushes_broken_away"] = object.limit.pushes;
  json[key + "pushes_held"] = object.limit.missed;
  for (const EstimatorTrace& trace : object.comparison) {
    const std::string method = key + "estimator." + name_of(trace.method) + ".";
    if (trace.settling) json[method + "settling_s"] = *trace.settling;
    json[method + "steady_error"] = trace.steady_error;
    if (trace.mean_force_error) json[method + "held_error"] = *trace.mean_force_error;
  }
  if (object.surface.status == LimitSurfaceFitStatus::fitted) {
    json[key + "limit_surface.median_angle_rad"] = object.surface.median_angle;
    json[key + "limit_surface.samples"] = object.surface.samples_used;
  }
  json[key + "notes"] = object.notes;
}

void add_offset(Json& json, const std::string& key, const TimeOffset& offset) {
  if (!offset.is_known) return;
  json[key + "_s"] = offset.offset;
  json[key + "_std_s"] = offset.std;
}

std::string format_json(const Identification& found, const std::string& recording) {
  Json json;
  json["format"] = "pcavr-identification/1";
  json["version"] = PCAVR_VERSION;
  json["recording"] = recording;
  json["units"] = "SI";
  add_offset(json, "time_offset.tool_to_force", found.tool_to_force);
  json["time_offset.is_applied"] = found.is_offset_applied;
  add_offset(json, "time_offset.tool_to_camera", found.tool_to_camera);
  json["force.noise_N"] = found.force_noise;
  json["force.largest_drift_N"] = found.max_drift;
  json["force.spikes"] = found.spikes;
  json["contacts"] = found.contacts.size();
  json["contacts_left_out"] = found.contacts_left_out();
  json["left_out"] = Json::array();
  for (const auto& [file, reason, count] : found.left_out) {
    json["left_out"].push_back({{"file", file}, {"reason", reason}, {"rows", count}});
  }
  for (const ObjectIdentification& object : found.objects) add_object(json, object);
  json["notes"] = found.notes;
  // JSON must be UTF-8, but a path need not be.
  return json_text(json, 2) + '\n';
}

}  // namespace

std::map<std::string, std::size_t> Identification::contacts_left_out() const {
  std::map<std::string, std::size_t> counts;
  for (const IdentifiedContact& contact : contacts) {
    if (!contact.left_out.empty()) ++counts[contact.left_out];
  }
  return counts;
}

Expected<void> write_identification_report(const Identification& found,
                                           const std::string& recording,
                                           const std::filesystem::path& folder) {
  const Expected<void> page = write_file(folder / "report.html", format_report(found, recording));
  if (!page) return page;
  return write_file(folder / "report.json", format_json(found, recording));
}

}  // namespace pcavr
