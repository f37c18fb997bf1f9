// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "results/export/exported_numbers.hpp"

#include <algorithm>
#include <map>

#include <fmt/core.h>

#include "pcavr/physics/object/parameters_file.hpp"

namespace pcavr::detail {
namespace {

std::string unit_of_key(const std::string& key, double exponent) {
  static const std::map<std::string, std::string> units{{"mass", "kg"},
                                                        {"inertial_mass", "kg"},
                                                        {"limiting_static_friction", "N"},
                                                        {"limiting_static_friction_scatter", "N"},
                                                        {"sliding_friction_coefficient", "1"},
                                                        {"tool_friction_coefficient", "1"},
                                                        {"viscous_friction", "N s/m"},
                                                        {"contact_exponent", "1"},
                                                        {"contact_mass", "kg"},
                                                        {"contact_restitution", "1"},
                                                        {"contact_impact_speed", "m/s"},
                                                        {"friction_radius", "m"},
                                                        {"loading_rate", "N/s"}};
  if (key == "contact_stiffness") return fmt::format("N/m^{}", exponent);
  if (key == "contact_damping") {
    return exponent == 1.0 ? "N s/m" : fmt::format("N s/m^{}", exponent + 1.0);
  }
  const auto unit = units.find(key);
  return unit == units.end() ? "" : unit->second;
}

double assumed_value(const std::string& key, const BodyPhysics& physics) {
  const FrictionParameters& friction = physics.friction;
  if (key == "mass") return friction.mass;
  if (key == "sliding_friction_coefficient") {
    return friction.coulomb_force / (friction.mass * kStandardGravity);
  }
  if (key == "limiting_static_friction") return friction.limiting_force;
  if (key == "viscous_friction") return friction.viscous;
  if (key == "contact_exponent") return physics.contact.exponent;
  if (key == "contact_stiffness") return physics.contact.stiffness;
  if (key == "contact_damping") return physics.contact.damping;
  if (key == "tool_friction_coefficient") return physics.tool_friction;
  return physics.friction_radius;
}

bool is_given(const ObjectParameters& known, std::string key) {
  const std::string contact = "contact_";
  if (key.starts_with(contact)) key.replace(0, contact.size(), "contact.");
  const auto& given = known.sources.given;
  if (std::find(given.begin(), given.end(), key) != given.end()) return true;
  // A weighed mass of the scene is not in a parameter file, and has no std.
  return key == "mass" && known.mass && !known.mass->std;
}

}  // namespace

std::vector<ExportedNumber> numbers_of(const std::string& object, const ObjectParameters& known,
                                       const CompletedPhysics& completed) {
  const double exponent = completed.physics.contact.exponent;
  std::vector<ExportedNumber> numbers;
  for (const auto& [key, parameter] : list_parameters(known)) {
    numbers.push_back({.object = object,
                       .key = key,
                       .value = parameter.value,
                       .std = parameter.std,
                       .unit = unit_of_key(key, exponent),
                       .origin = is_given(known, key) ? "given" : "measured"});
  }
  for (const std::string& key : completed.assumed) {
    numbers.push_back({.object = object,
                       .key = key,
                       .value = assumed_value(key, completed.physics),
                       .unit = unit_of_key(key, exponent),
                       .origin = "assumed"});
  }
  return numbers;
}

}  // namespace pcavr::detail
