// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "friction_atlas.hpp"

#include <algorithm>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "pcavr/base/core/csv_field.hpp"
#include "pcavr/base/core/decimal.hpp"
#include "pcavr/base/core/output.hpp"

namespace pcavr {
namespace {

struct AtlasKey {
  const char* key;  ///< as in the parameter file
  std::optional<ParameterValue> ObjectParameters::*value;
  const char* unit;
};
const std::array<AtlasKey, 4> kKeys{
    {{"sliding_friction_coefficient", &ObjectParameters::sliding_friction_coefficient, "1"},
     {"limiting_static_friction", &ObjectParameters::limiting_static_friction, "N"},
     {"viscous_friction", &ObjectParameters::viscous_friction, "N s/m"},
     {"friction_radius", &ObjectParameters::friction_radius, "m"}}};

std::string origin_of(const std::string& key, const ObjectParameters& parameters) {
  return std::ranges::count(parameters.sources.given, key) > 0 ? "given" : "identified";
}

std::string row_end(const std::optional<ParameterValue>& value, const char* unit,
                    const std::string& origin) {
  if (!value) return fmt::format(",,{},not identified\n", unit);
  const std::string std = value->std ? shortest_decimal(*value->std) : "";
  return fmt::format("{},{},{},{}\n", shortest_decimal(value->value), std, unit, origin);
}

/// The surface's scales, which count as exact, and coefficients.
std::string surface_rows(const std::string& begin, const ObjectParameters& parameters,
                         const SurfaceStd& std) {
  const std::optional<LimitSurface>& surface = parameters.limit_surface;
  if (!surface) return begin + "limit_surface," + row_end({}, "1", {});
  const std::string origin = origin_of("limit_surface", parameters);
  const auto row = [&](const std::string& key, const ParameterValue& value, const char* unit) {
    return begin + "limit_surface." + key + ',' + row_end(value, unit, origin);
  };
  std::string text = row("force", {surface->force}, "N") + row("length", {surface->length}, "m");
  for (std::size_t i = 0; i < surface->coefficients.size(); ++i) {
    const auto& [x, y, m] = kQuarticExponents[i];
    const std::optional<double> own = std ? std::optional((*std)[i]) : std::nullopt;
    text += row(fmt::format("fx{}_fy{}_m{}", x, y, m), {surface->coefficients[i], own}, "1");
  }
  return text;
}

}  // namespace

std::string format_atlas_rows(const std::string& object, const std::string& support,
                              std::size_t recordings, const ObjectParameters& parameters,
                              const SurfaceStd& surface_std) {
  const std::string begin =
      fmt::format("{},{},{},", csv_field(object), csv_field(support), recordings);
  std::string text;
  for (const AtlasKey& entry : kKeys) {
    text += begin + entry.key + ',' +
            row_end(parameters.*entry.value, entry.unit, origin_of(entry.key, parameters));
  }
  return text + surface_rows(begin, parameters, surface_std);
}

Expected<std::map<std::string, SurfaceStd>> read_surface_stds(const std::filesystem::path& report) {
  const Expected<std::string> text = read_file(report);
  if (!text) return text.error();
  std::map<std::string, SurfaceStd> stds;
  try {
    for (const nlohmann::json& object : nlohmann::json::parse(*text).at("objects")) {
      const auto surface = object.find("limit_surface");
      if (surface == object.end() || !surface->contains("coefficients_std")) continue;
      stds[object.at("name").get<std::string>()] =
          surface->at("coefficients_std").get<std::array<double, 15>>();
    }
  } catch (const nlohmann::json::exception& failure) {
    return Error{.message = std::string("is no report of pcavr: ") + failure.what(),
                 .file = report.string()};
  }
  return stds;
}

}  // namespace pcavr
