// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/object/parameters_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string_view>
#include <vector>

#include "pcavr/base/core/content_id.hpp"
#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/physics/object/contact_units.hpp"
#include "pcavr/recordings/recording/manifest_parser.hpp"
#include "pcavr/recordings/recording/yaml_map.hpp"

#include "physics/object/parameter_fields.hpp"

namespace pcavr {
namespace {

using namespace parameter_file;

constexpr InputRange kCorrelation{"correlation", -1.0, 1.0, "1", "by definition"};
constexpr InputRange kSurfaceOffset{"surface offset", -0.001, 0.001, "m",
                                    "more is a wrong pose or mesh"};
/// Files without a format are of version 1, whose keys are a subset.
void expect_format(const YamlValue& format) {
  if (format.text() == kFormat) return;
  format.fail(
      "is not " + std::string(kFormat),
      "identify the parameters with this version of pcavr, or rename an object of this name");
}

void read_field(const YamlValue& map, const Field& field, ObjectParameters& parameters) {
  const std::optional<YamlValue> value = map.find(field.key);
  const std::optional<YamlValue> std_value = map.find(std_key(field));
  if (!value) {
    if (std_value) {
      std_value->fail("is given without " + std::string(field.key),
                      "add the value, or remove its std");
    }
    return;
  }
  ParameterValue parameter{.value = value->number_in(field.range)};
  if (std_value) parameter.std = std_value->number_in(ranges::kParameterStd);
  parameters.*field.member = parameter;
}

/// Whether the quartic H is positive and its level set convex: each tangent plane is a supporting
/// plane, with the whole surface on one side. Checked for many directions, each against each
/// (Fibonacci sphere).
bool is_convex(const std::array<double, 15>& coefficients) {
  constexpr int kDirections = 200;
  constexpr double kMinLevel = 1e-4;  // below, the surface is degenerate in the given scales
  constexpr double kRounding = 1e-6;
  const LimitSurface surface{1.0, 1.0, coefficients};
  std::vector<Eigen::Vector3d> directions;
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (int i = 0; i < kDirections; ++i) {
    const double z = 1.0 - (2 * i + 1.0) / kDirections;
    const double r = std::sqrt(1.0 - z * z);
    directions.emplace_back(r * std::cos(golden * i), r * std::sin(golden * i), z);
  }
  for (const Eigen::Vector3d& at : directions) {
    const double size = level(surface, at);
    if (!(size > kMinLevel) || !std::isfinite(size)) return false;
    const Eigen::Vector3d tangent = sliding_direction(surface, at) / (4.0 * std::pow(size, 3));
    for (const Eigen::Vector3d& other : directions) {
      if (!(tangent.dot(other) <= level(surface, other) * (1.0 + kRounding))) return false;
    }
  }
  return true;
}

LimitSurface read_limit_surface(const YamlValue& map) {
  map.expect_keys({"force", "length", "coefficients"});
  LimitSurface surface{.force = map.at("force").number_in(ranges::kStaticFriction),
                       .length = map.at("length").number_in(ranges::kFrictionRadius)};
  const YamlValue list = map.at("coefficients");
  const std::vector<double> coefficients = list.numbers(surface.coefficients.size());
  std::copy(coefficients.begin(), coefficients.end(), surface.coefficients.begin());
  if (!is_convex(surface.coefficients)) {
    list.fail("are not those of a convex surface", "identify it again, or remove limit_surface");
  }
  return surface;
}

bool is_parameter_key(std::string_view key) { return field_of_key(key) != nullptr; }

/// Names of parameters, each at most once.
std::vector<std::string> read_keys(const YamlValue& list) {
  std::vector<std::string> keys;
  for (const YamlValue& item : list.items()) {
    const std::string key = item.text();
    if (!is_parameter_key(key)) {
      item.fail("is no parameter: " + key, "name it as in this file, such as contact.stiffness");
    }
    if (std::find(keys.begin(), keys.end(), key) != keys.end()) {
      item.fail(key + " is listed twice", "list it once");
    }
    keys.push_back(key);
  }
  return keys;
}

std::map<std::string, int> read_counts(const YamlValue& map) {
  constexpr int kMaxCount = 1'000'000;
  std::map<std::string, int> counts;
  for (const auto& [key, count] : map.entries()) {
    if (!is_parameter_key(key)) {
      count.fail("is no parameter", "name it as in this file, such as contact.stiffness");
    }
    counts[key] = count.integer(0, kMaxCount);
  }
  return counts;
}

void read_correlation(const YamlValue& map, ParameterSources& sources) {
  map.expect_keys({"parameters", "matrix"});
  sources.correlated = read_keys(map.at("parameters"));
  const std::vector<YamlValue> rows = map.at("matrix").items();
  if (rows.size() != sources.correlated.size()) {
    map.at("matrix").fail("has " + std::to_string(rows.size()) + " rows for " +
                              std::to_string(sources.correlated.size()) + " parameters",
                          "write one row for each parameter");
  }
  for (const YamlValue& row : rows) {
    const std::vector<double> values = row.numbers_in(rows.size(), kCorrelation);
    sources.correlation.insert(sources.correlation.end(), values.begin(), values.end());
  }
}

std::vector<SlidingForce> read_sliding_force(const YamlValue& list) {
  std::vector<SlidingForce> rows;
  for (const YamlValue& row : list.items()) {
    row.expect_keys({"speed", "force", "std"});
    rows.push_back({row.at("speed").positive_number(),
                    row.at("force").number_in(ranges::kStaticFriction),
                    row.at("std").number_in(ranges::kParameterStd)});
  }
  return rows;
}

/// Contents of recordings, as content_id writes them.
std::vector<std::string> read_recordings(const YamlValue& list) {
  std::vector<std::string> recordings;
  for (const YamlValue& item : list.items()) {
    recordings.push_back(item.text());
    if (!is_content_id(recordings.back()))
      item.fail("is not the content of a recording", "identify the parameters again");
  }
  std::ranges::sort(recordings);
  return recordings;
}

void read_sources(const YamlValue& map, ParameterSources& sources) {
  if (const auto given = map.find("given")) sources.given = read_keys(*given);
  if (const auto pushes = map.find("pushes")) sources.pushes = read_counts(*pushes);
  if (const auto presses = map.find("presses")) sources.presses = read_counts(*presses);
  if (const auto impacts = map.find("impacts")) sources.impacts = read_counts(*impacts);
  if (const auto list = map.find("recordings")) sources.recordings = read_recordings(*list);
  if (const auto correlation = map.find("correlation")) read_correlation(*correlation, sources);
}

/// The stated law and unit of damping must be those of the exponent, so that no number is read
/// under another law than it was written for. Files of older versions state neither.
void check_contact_law(const YamlValue& contact, const ObjectParameters& parameters) {
  const double exponent = parameters.contact_exponent ? parameters.contact_exponent->value : 1.0;
  if (exponent != 1.0 && parameters.contact_mass) {
    contact.at("mass").fail("is given for an exponent other than 1",
                            "remove it, or give the exponent of mass_damper_spring, 1");
  }
  const std::string name(contact_law_name(exponent, parameters.contact_mass.has_value()));
  const std::optional<YamlValue> law = contact.find("law");
  if (law && law->text() != name) {
    law->fail("is not the law of this exponent",
              "state " + name +
                  ", or an exponent of 1 for kelvin_voigt, also a mass for "
                  "mass_damper_spring, and above 1 for hunt_crossley");
  }
  const std::string unit = damping_unit(exponent);
  const std::optional<YamlValue> stated_unit = contact.find("damping_unit");
  if (stated_unit && stated_unit->text() != unit) {
    stated_unit->fail("is not the unit of the damping under this exponent",
                      "give the damping in " + unit + ", or the exponent that it is for");
  }
}

void read_damping_law(const YamlValue& contact, ObjectParameters& parameters) {
  const std::optional<YamlValue> name = contact.find("damping_law");
  if (!name || name->text() == kFittedDamping) return;
  parameters.contact_damping_law = damping_law_of(name->text());
  if (parameters.contact_damping_law) return;
  name->fail("is no damping law: " + name->text(),
             "name fitted, exact, or a published one, such as gonthier");
}

ObjectParameters read_object(const YamlValue& map) {
  map.expect_keys({"mass",
                   "mass_std",
                   "inertial_mass",
                   "inertial_mass_std",
                   "limiting_static_friction",
                   "limiting_static_friction_std",
                   "limiting_static_friction_scatter",
                   "limiting_static_friction_scatter_std",
                   "sliding_friction_coefficient",
                   "sliding_friction_coefficient_std",
                   "viscous_friction",
                   "viscous_friction_std",
                   "contact",
                   "friction_radius",
                   "friction_radius_std",
                   "tool_friction_coefficient",
                   "tool_friction_coefficient_std",
                   "loading_rate",
                   "loading_rate_std",
                   "limit_surface",
                   "sliding_force",
                   "given",
                   "pushes",
                   "recordings",
                   "presses",
                   "impacts",
                   "correlation"});
  ObjectParameters parameters;
  for (const Field& field : kFields) read_field(map, field, parameters);
  if (const std::optional<YamlValue> contact = map.find("contact")) {
    contact->expect_keys({"law", "stiffness", "stiffness_std", "damping", "damping_std",
                          "damping_unit", "damping_law", "exponent", "exponent_std", "mass",
                          "mass_std", "restitution", "restitution_std", "impact_speed",
                          "impact_speed_std", "surface_offset"});
    for (const Field& field : kContactFields) read_field(*contact, field, parameters);
    if (const auto offset = contact->find("surface_offset")) {
      const std::vector<double> values = offset->numbers_in(3, kSurfaceOffset);
      parameters.contact_surface_offset = Eigen::Vector3d(values[0], values[1], values[2]);
    }
    check_contact_law(*contact, parameters);
    read_damping_law(*contact, parameters);
  }
  if (const std::optional<YamlValue> surface = map.find("limit_surface")) {
    parameters.limit_surface = read_limit_surface(*surface);
  }
  if (const auto rows = map.find("sliding_force")) {
    parameters.sliding_force = read_sliding_force(*rows);
  }
  read_sources(map, parameters.sources);
  return parameters;
}

}  // namespace

Expected<ParameterTable> parse_parameters(const std::string& text, const std::string& file) {
  return parse_yaml<ParameterTable>(text, file, [](const YamlValue& root) {
    ParameterTable table;
    for (const auto& [name, map] : root.entries()) {
      if (name == kFormatKey) {
        expect_format(map);
        continue;
      }
      expect_object_name(name, map);
      table.emplace(name, read_object(map));
    }
    return table;
  });
}

Expected<ParameterTable> read_parameters(const std::filesystem::path& file) {
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  return parse_parameters(*text, file.string());
}

}  // namespace pcavr
