// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "pcavr/contact/damping.hpp"
#include "pcavr/contact/impact.hpp"
#include "pcavr/core/json_text.hpp"
#include "pcavr/core/output.hpp"
#include "pcavr/report/number_text.hpp"
#include "pcavr/report/report_page.hpp"

#include "identify_plots.hpp"

namespace pcavr {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMilliseconds = 1e3;

/// A number of any magnitude: stiffnesses of nonlinear laws may be very large.
std::string figure(double value) {
  if (std::abs(value) < 1e5) return readable(value);
  return fmt::format("{:.3g}", value);
}

ReportTable findings_table(const ObjectIdentification& object) {
  ReportTable table{.title = "",
                    .columns = {"parameter", "value", "± std", "unit", "identified",
                                "source, or the motion that would identify it"}};
  for (const ParameterFinding& row : object.findings) {
    const bool is_known = row.is_excited || row.value != 0.0;
    table.rows.push_back({row.name, is_known ? figure(row.value) : "-",
                          row.std ? figure(*row.std) : "-", row.unit, row.is_excited ? "yes" : "no",
                          row.remark});
  }
  return table;
}

ReportTable comparison_table(const ObjectIdentification& object) {
  ReportTable table{
      .title = "Estimators on the presses",
      .columns = {"method", "until the first press's peak is predicted within 10 % (ms)",
                  "steady error (%)", "mean force error, tip stationary (%)"}};
  for (const EstimatorTrace& trace : object.comparison) {
    table.rows.push_back(
        {name_of(trace.method),
         trace.settling ? fixed(*trace.settling * kMilliseconds, 0) : "never",
         readable(trace.steady_error * kPercent),
         trace.mean_force_error ? readable(*trace.mean_force_error * kPercent) : "-"});
  }
  return table;
}

std::string text_with_std(const IdentifiedParameter& parameter) {
  return figure(parameter.value) + " ± " + figure(parameter.std);
}

ReportTable faces_table(const ObjectIdentification& object) {
  ReportTable table{
      .title = "Faces, from pushes before breakaway",
      .columns = {"normal in the object's axes", "pushes", "stiffness", "damping", "exponent"}};
  for (const FaceContact& face : object.faces) {
    const ContactFit& fit = face.contact.best();
    const Eigen::Vector3d& n = face.normal_object;
    const bool has_damping = fit.damping.is_excited && fit.damping.value > 0.0;
    table.rows.push_back({fixed(n.x(), 2) + " " + fixed(n.y(), 2) + " " + fixed(n.z(), 2),
                          std::to_string(face.pushes),
                          fit.is_valid ? text_with_std(fit.stiffness) : "-",
                          !fit.is_valid ? "-"
                          : has_damping ? text_with_std(fit.damping)
                                        : "not identified",
                          fit.is_valid ? fixed(fit.exponent.value, 2) + ", given" : "-"});
  }
  return table;
}

/// Pushes whose line a press checks.
ReportTable press_lines_table(const Identification& found, std::size_t object) {
  ReportTable table{
      .title = "Pushes beside the press's law [paper C, figure 5]",
      .columns = {"breakaway at (s)", "force at its peak (N)", "stiffness, push over press",
                  "force where it leaves the press's line (N)"}};
  for (const IdentifiedContact& contact : found.contacts) {
    if (contact.object != object || !contact.press_line) continue;
    const PressLine& line = *contact.press_line;
    if (!line.ratio.is_excited) continue;
    table.rows.push_back({fixed(contact.episode.breakaway.t, 2),
                          readable(contact.episode.breakaway.force), text_with_std(line.ratio),
                          line.t_mutation ? readable(line.force) : "does not leave it"});
  }
  return table;
}

ReportTable impacts_table(const ObjectIdentification& object) {
  ReportTable table{.title = "Impacts",
                    .columns = {"time (s)", "duration (ms)", "approach (mm/s)", "restitution",
                                "published law with the smallest error",
                                "damping over stiffness, exact (s/m)", "tool's mass (kg)"}};
  for (const MeasuredImpact& impact : object.impacts) {
    const double approach = impact.approach_speed.value * 1e3;
    table.rows.push_back(
        {fixed(impact.t, 2), fixed(impact.duration * kMilliseconds, 0), fixed(approach, 0),
         text_with_std(impact.restitution), std::string(name_of(impact.law)),
         text_with_std(impact.damping_over_stiffness), text_with_std(impact.mass)});
  }
  return table;
}

PageSection object_section(const Identification& found, std::size_t index) {
  const ObjectIdentification& object = found.objects[index];
  PageSection section{.title = object.name};
  for (const std::string& text : object.notes) section.blocks.emplace_back(PageText{text, true});
  std::vector<ReportTable> tables{findings_table(object)};
  for (ReportTable& table :
       std::array{comparison_table(object), faces_table(object), press_lines_table(found, index),
                  impacts_table(object), critical_band_table(found, index)}) {
    if (!table.rows.empty()) tables.push_back(std::move(table));
  }
  section.blocks.emplace_back(std::move(tables));
  PlotGroup group{"Plots", contact_plots(object)};
  if (!object.impacts.empty()) group.plots.push_back(damping_laws_plot(object));
  if (found.goal == IdentificationGoal::friction) {
    if (const auto lines = force_lines(found, index)) {
      group.plots.push_back(force_lines_plot(*lines));
    }
    for (const auto& plots :
         {push_plots(found, index), sliding_plots(object), surface_plots(object)}) {
      group.plots.insert(group.plots.end(), plots.begin(), plots.end());
    }
  }
  if (!group.plots.empty()) section.blocks.emplace_back(std::move(group));
  return section;
}

std::string offset_text(const TimeOffset& offset) {
  if (!offset.is_known) return "not known: this recording does not identify it";
  return fixed(offset.offset * kMilliseconds, 2) + " ± " + fixed(offset.std * kMilliseconds, 2) +
         " ms";
}

/// How much was identified, by object.
std::string verdict_of(const Identification& found) {
  std::string text;
  for (const ObjectIdentification& object : found.objects) {
    const auto identified =
        std::count_if(object.findings.begin(), object.findings.end(),
                      [](const ParameterFinding& row) { return row.is_excited; });
    text += fmt::format("{}{}: {} of {} parameters identified", text.empty() ? "" : "; ",
                        object.name, identified, object.findings.size());
  }
  return text.empty() ? text : text + ".";
}

ReportPage identification_page(const Identification& found, const std::string& recording) {
  ReportPage page{.title = "Identification: " + recording,
                  .heading = found.goal == IdentificationGoal::contact
                                 ? "Identification of contact"
                                 : "Identification of contact and friction"};
  page.inputs = {{{"recording "}, {recording, true}},
                 {{"force after tool: "},
                  {offset_text(found.inputs.tool_to_force), true},
                  {found.inputs.is_force_offset_applied ? ", removed" : ""}},
                 {{"tracking after tool: "}, {offset_text(found.inputs.tool_to_camera), true}},
                 {{"force noise "},
                  {readable(found.inputs.force_noise) + " N", true},
                  {", bias up to "},
                  {readable(found.inputs.max_drift) + " N", true},
                  {", "},
                  {std::to_string(found.inputs.force_spikes), true},
                  {" spikes removed"}}};
  page.verdict = verdict_of(found);
  page.notes = found.notes;
  for (std::size_t i = 0; i < found.objects.size(); ++i) {
    page.sections.push_back(object_section(found, i));
  }
  page.footer =
      "F = stiffness dⁿ + damping dⁿ ḋ (n = 1: damping ḋ). Std: standard deviation of the value. "
      "Friction and mass: of their posterior, with the scatter between pushes; contact law: for "
      "independent noise, without errors of the model. The same figures in SI units are in "
      "report.json. pcavr " +
      std::string(PCAVR_VERSION);
  return page;
}

/// Paper B's figure 6 with this object's restitution, and its impacts.
void add_impacts(Json& json, const std::string& key, const ObjectIdentification& object) {
  if (object.impacts.empty()) return;
  Json& impacts = json[key + "impacts"] = Json::array();
  for (const MeasuredImpact& impact : object.impacts) {
    impacts.push_back({{"t", impact.t},
                       {"duration_s", impact.duration},
                       {"approach_speed", impact.approach_speed.value},
                       {"restitution", impact.restitution.value},
                       {"restitution_std", impact.restitution.std},
                       {"tool_mass", impact.mass.value},
                       {"damping_over_stiffness", impact.damping_over_stiffness.value},
                       {"best_published_law", key_of(impact.law)}});
  }
  const double restitution = object.impact_findings.restitution.value;
  for (const DampingScore& score : score_damping_laws(restitution)) {
    json[key + "damping_law_error." + std::string(key_of(score.law))] = score.relative_error;
  }
  if (json.contains("damping_law_errors")) return;
  Json& figure = json["damping_law_errors"];
  for (const DampingErrorCurve& curve : damping_error_curves()) {
    figure["restitution"] = curve.restitution;
    figure[std::string(key_of(curve.law))] = curve.relative_error;
  }
}

/// Every push beside the press's law, and paper C's figure 5 of the first one.
void add_pushes(Json& json, const std::string& key, const Identification& found,
                std::size_t object) {
  Json pushes = Json::array();
  for (const IdentifiedContact& contact : found.contacts) {
    const Breakaway& breakaway = contact.episode.breakaway;
    if (contact.object != object || !contact.left_out.empty() || !breakaway.is_found) continue;
    Json push{{"t_breakaway", breakaway.t},
              {"force", breakaway.force},
              {"line_stiffness", breakaway.stiffness}};
    if (contact.limit.is_excited) push["limit"] = contact.limit.value;
    if (contact.press_line && contact.press_line->ratio.is_excited) {
      push["press_line_ratio"] = contact.press_line->ratio.value;
      push["press_line_ratio_std"] = contact.press_line->ratio.std;
    }
    if (contact.press_line && contact.press_line->t_mutation) {
      push["press_line_t"] = *contact.press_line->t_mutation;
      push["press_line_force"] = contact.press_line->force;
    }
    pushes.push_back(std::move(push));
  }
  if (!pushes.empty()) json[key + "breakaways"] = std::move(pushes);
  const std::optional<ForceLines> lines = force_lines(found, object);
  if (!lines) return;
  Json& figure = json[key + "force_lines"];
  figure = {{"t", lines->t},
            {"measured", lines->measured},
            {"push_line", lines->push_line},
            {"t_alarm", lines->t_alarm},
            {"t_breakaway", lines->t_breakaway}};
  if (!lines->press_line.empty()) figure["press_line"] = lines->press_line;
  if (lines->t_mutation) figure["t_mutation"] = *lines->t_mutation;
}

void add_object(Json& json, const Identification& found, std::size_t index) {
  const ObjectIdentification& object = found.objects[index];
  const std::string key = "object." + object.name + ".";
  for (const ParameterFinding& row : object.findings) {
    if (row.is_excited || row.value != 0.0) json[key + row.name] = row.value;
    if (row.std && std::isfinite(*row.std)) json[key + row.name + "_std"] = *row.std;
    json[key + row.name + ".is_excited"] = row.is_excited;
    json[key + row.name + ".remark"] = row.remark;
  }
  Json& forces = json[key + "sliding_force"] = Json::array();
  for (const SlidingForce& row : object.friction.sliding_force) {
    forces.push_back({{"speed", row.speed}, {"force", row.force}, {"std", row.std}});
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
  add_impacts(json, key, object);
  if (found.goal == IdentificationGoal::friction) add_pushes(json, key, found, index);
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
  for (const auto& [key, value] : found.configuration) json["configuration"][key] = value;
  add_offset(json, "time_offset.tool_to_force", found.inputs.tool_to_force);
  json["time_offset.is_applied"] = found.inputs.is_force_offset_applied;
  add_offset(json, "time_offset.tool_to_camera", found.inputs.tool_to_camera);
  json["force.noise_N"] = found.inputs.force_noise;
  json["force.largest_drift_N"] = found.inputs.max_drift;
  json["force.spikes"] = found.inputs.force_spikes;
  json["contacts"] = found.contacts.size();
  json["contacts_left_out"] = found.contacts_left_out();
  json["left_out"] = Json::array();
  for (const auto& [file, reason, count] : found.left_out) {
    json["left_out"].push_back({{"file", file}, {"reason", reason}, {"rows", count}});
  }
  for (std::size_t i = 0; i < found.objects.size(); ++i) add_object(json, found, i);
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
  const Expected<void> page = write_report_page(identification_page(found, recording), folder);
  if (!page) return page;
  return write_file(folder / "report.json", format_json(found, recording));
}

}  // namespace pcavr
