// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "pcavr/base/core/json_text.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/results/export/write_export.hpp"

namespace pcavr {
namespace {

using Json = nlohmann::ordered_json;

Json number_json(const ExportedNumber& number) {
  Json json{{"object", number.object}, {"key", number.key}, {"value", number.value}};
  if (number.std) json["std"] = *number.std;
  json["unit"] = number.unit;
  json["origin"] = number.origin;
  return json;
}

Json residual_json(const ExportResidual& residual) {
  return {{"object", residual.object},   {"what", residual.what}, {"wanted", residual.wanted},
          {"written", residual.written}, {"unit", residual.unit}, {"relative", residual.relative()},
          {"remark", residual.remark}};
}

Json friction_json(const ExportedBody& body) {
  const double depth = static_penetration(body.contact, body.working_force);
  return {{"name", body.name},
          {"feet", body.feet.size()},
          {"mass", body.inertia.mass},
          {"friction", body.friction},
          {"static_friction", body.static_friction},
          {"coulomb_friction", body.coulomb_friction},
          {"viscous", body.viscous},
          {"stribeck_speed", body.stribeck_speed},
          {"friction_radius", body.friction_radius},
          {"press_depths", {depth, 0.5 * depth}}};
}

Json correlation_json(const ParameterSources& sources) {
  Json rows = Json::array();
  const std::size_t n = sources.correlated.size();
  for (std::size_t i = 0; i < n; ++i) {
    rows.push_back(std::vector<double>(
        sources.correlation.begin() + static_cast<std::ptrdiff_t>(i * n),
        sources.correlation.begin() + static_cast<std::ptrdiff_t>((i + 1) * n)));
  }
  return {{"parameters", sources.correlated}, {"matrix", rows}};
}

}  // namespace

Expected<void> write_export_manifest(const ExportedWorld& world, const ParameterTable& parameters,
                                     const std::string& format,
                                     const std::filesystem::path& folder) {
  Json json{{"format", "pcavr-export/1"}, {"written_as", format}, {"recording", world.source}};
  json["tool"] = world.tool.name;
  for (const char* list : {"bodies", "numbers", "correlation", "residuals", "warnings"}) {
    json[list] = Json::array();
  }
  for (const ExportedBody& body : world.bodies) {
    if (body.is_movable) json["bodies"].push_back(friction_json(body));
  }
  for (const ExportedNumber& number : world.numbers) json["numbers"].push_back(number_json(number));
  json["correlation"] = Json::object();
  for (const auto& [name, known] : parameters) {
    if (!known.sources.correlated.empty()) {
      json["correlation"][name] = correlation_json(known.sources);
    }
  }
  for (const ExportResidual& residual : world.residuals) {
    json["residuals"].push_back(residual_json(residual));
  }
  for (const std::string& warning : world.warnings) json["warnings"].push_back(warning);
  return write_file(folder / kExportManifest, json_text(json, 1) + '\n');
}

}  // namespace pcavr
