// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "pcavr/base/core/json_text.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/base/report/report_page.hpp"
#include "pcavr/physics/contact/damping.hpp"
#include "pcavr/physics/contact/impact.hpp"

#include "identify_page.hpp"
#include "identify_plots.hpp"

namespace pcavr {
namespace {

using Json = nlohmann::ordered_json;

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
  for (const Contact& contact : found.contacts) {
    const Breakaway& breakaway = contact.breakaway;
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
  if (object.penetration.force > 0.0) {
    json[key + "contact.penetration_force"] = object.penetration.force;
  }
  Json& forces = json[key + "sliding_force"] = Json::array();
  if (!object.friction.sliding_force.empty()) {  // else the parameters have what was known before
    for (const SlidingForce& row : object.parameters.sliding_force) {
      forces.push_back({{"speed", row.speed}, {"force", row.force}, {"std", row.std}});
    }
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
  for (const Contact& contact : contacts) {
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
