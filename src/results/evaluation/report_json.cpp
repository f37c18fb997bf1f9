// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "pcavr/base/core/json_text.hpp"

#include "report.hpp"

namespace pcavr {
namespace {

using Json = nlohmann::ordered_json;

/// Keys end in `si_unit`; ratios have none.
void add_statistics(Json& json, const std::string& key, const std::string& si_unit,
                    const ErrorStatistics& stats) {
  const std::string unit = si_unit.empty() ? "" : "_" + si_unit;
  json[key + ".count"] = stats.count;
  json[key + ".max" + unit] = stats.max;
  json[key + ".mean" + unit] = stats.mean;
  json[key + ".median" + unit] = stats.median;
  json[key + ".min" + unit] = stats.min;
  json[key + ".rmse" + unit] = stats.rmse;
  json[key + ".sse" + (unit.empty() ? "" : unit + "2")] = stats.sse;
  json[key + ".std" + unit] = stats.std;
  json[key + ".p95" + unit] = stats.p95;
}

void add_placement(Json& json, const PlacementFindings& placed) {
  const std::string key = "placed." + placed.name + "." + placed.when + ".";
  json[key + "translation_m"] = placed.translation;
  json[key + "rotation_rad"] = placed.rotation;
  if (placed.model) {
    json[key + "add_m"] = placed.model->add;
    json[key + "mssd_m"] = placed.model->mssd;
  }
}

void add_surface(Json& json, const SurfaceFindings& surface) {
  json["mesh.completeness_5mm"] = surface.errors.completeness_5mm;
  json["mesh.completeness_10mm"] = surface.errors.completeness_10mm;
  json["mesh.reference_samples"] = surface.errors.seen_truth_to_mesh.size();
  json["mesh.views"] = surface.views;
  if (surface.left_behind) json["mesh.share_left_behind"] = *surface.left_behind;
  json["mesh.share_not_explained"] = surface.errors.share_not_explained;
}

Json headline_of(const Report& report) {
  Json list = Json::array();
  for (const Metric& metric : report.headline) {
    list.push_back({{"name", metric.name}, {"value", metric.value}, {"unit", metric.unit}});
  }
  return list;
}

}  // namespace

std::string format_json(const Report& report, const Findings& findings) {
  Json json;
  json["format"] = "pcavr-report/1";
  json["version"] = PCAVR_VERSION;
  json["subject"] = report.subject;
  json["subject_kind"] = report.subject_kind;
  json["reference"] = report.reference;
  json["reference_kind"] = report.reference_kind;
  json["recording"] = report.recording;
  for (const auto& [key, value] : report.configuration) json["configuration"][key] = value;
  json["units"] =
      "SI, named at the end of each key; shares and completeness are fractions (0 to 1)";
  json["headline"] = headline_of(report);
  if (findings.camera) json["camera.unmatched"] = findings.camera->errors.unmatched;
  for (const ObjectFindings& object : findings.objects) {
    json["object." + object.name + "." + object.source + ".unmatched"] = object.errors.unmatched;
  }
  for (const ReportSection& section : report.sections) {
    for (const ErrorRow& row : section.rows) {
      add_statistics(json, section.key + "." + row.key, row.unit, row.stats);
    }
    for (const ReportValue& value : section.values) {
      std::visit([&](const auto& content) { json[value.key] = content; }, value.value);
    }
  }
  for (const PlacementFindings& placed : findings.placements) add_placement(json, placed);
  if (findings.surface) add_surface(json, *findings.surface);
  json["objects_missing"] = findings.objects_missing;
  // A path need not be UTF-8, but JSON is.
  return json_text(json, 2) + '\n';
}

}  // namespace pcavr
