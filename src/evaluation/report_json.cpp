// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "core/json_text.hpp"
#include "report.hpp"

namespace pcavr {
namespace {

using Json = nlohmann::ordered_json;

/// `si_unit` ends the keys; shares have none.
void add_statistics(Json& json, const std::string& key, const std::string& si_unit,
                    const ErrorStatistics& figures) {
  const std::string unit = si_unit.empty() ? "" : "_" + si_unit;
  json[key + ".count"] = figures.count;
  json[key + ".max" + unit] = figures.max;
  json[key + ".mean" + unit] = figures.mean;
  json[key + ".median" + unit] = figures.median;
  json[key + ".min" + unit] = figures.min;
  json[key + ".rmse" + unit] = figures.rmse;
  json[key + ".sse" + (unit.empty() ? "" : unit + "2")] = figures.sse;
  json[key + ".std" + unit] = figures.std;
  json[key + ".p95" + unit] = figures.p95;
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
  for (const Figure& figure : report.headline) {
    list.push_back({{"name", figure.name}, {"value", figure.value}, {"unit", figure.unit}});
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
  json["units"] = "SI, named at the end of each key; shares and completeness are of 1";
  json["headline"] = headline_of(report);
  if (findings.camera) json["camera.unmatched"] = findings.camera->errors.unmatched;
  for (const ObjectFindings& object : findings.objects) {
    json["object." + object.name + "." + object.source + ".unmatched"] = object.errors.unmatched;
  }
  for (const ReportSection& section : report.sections) {
    for (const ErrorRow& row : section.rows) {
      add_statistics(json, section.key + "." + row.key, row.unit, row.figures);
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
