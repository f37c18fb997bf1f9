// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "parameter_errors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/physics/contact/hunt_crossley.hpp"
#include "pcavr/physics/contact/impact.hpp"

namespace pcavr {
namespace {

struct Kind {
  const char* name;
  const char* unit;
  std::optional<ParameterValue> ObjectParameters::*member;
  bool depends_on_exponent = false;
};

const std::array kKinds = {
    Kind{"mass", "kg", &ObjectParameters::mass},
    Kind{"limiting_static_friction", "N", &ObjectParameters::limiting_static_friction},
    Kind{"sliding_friction_coefficient", "", &ObjectParameters::sliding_friction_coefficient},
    Kind{"viscous_friction", "N s/m", &ObjectParameters::viscous_friction},
    Kind{"contact.stiffness", "N/m^n", &ObjectParameters::contact_stiffness, true},
    Kind{"contact.damping", "N s/m^(n+1)", &ObjectParameters::contact_damping, true},
    Kind{"contact.exponent", "", &ObjectParameters::contact_exponent},
    Kind{"contact.mass", "kg", &ObjectParameters::contact_mass},
    Kind{"friction_radius", "m", &ObjectParameters::friction_radius},
    Kind{"tool_friction_coefficient", "", &ObjectParameters::tool_friction_coefficient}};

void compare(ParameterError& error) {
  if (!error.estimate || !error.truth) return;
  const double difference = error.estimate->value - *error.truth;
  if (*error.truth != 0.0) error.relative = difference / *error.truth;
  const std::optional<double>& estimate_std = error.estimate->std;
  if (estimate_std && *estimate_std > 0.0) error.error_in_std = difference / *estimate_std;
}

bool same_exponent(const ObjectParameters& a, const ObjectParameters& b) {
  return a.contact_exponent && b.contact_exponent &&
         a.contact_exponent->value == b.contact_exponent->value;
}

/// Elastic forces at one penetration; nothing where a law or the limiting friction is unknown.
std::optional<ParameterError> contact_force_error(const std::string& object,
                                                  const ObjectParameters& truth,
                                                  const ObjectParameters& estimate) {
  if (!truth.limiting_static_friction || !truth.contact_stiffness || !truth.contact_exponent ||
      !estimate.contact_stiffness || !estimate.contact_exponent) {
    return std::nullopt;
  }
  const double force = truth.limiting_static_friction->value;
  const HuntCrossley true_law{.stiffness = truth.contact_stiffness->value,
                              .exponent = truth.contact_exponent->value};
  const HuntCrossley law{.stiffness = estimate.contact_stiffness->value,
                         .exponent = estimate.contact_exponent->value};
  const double estimated = elastic_force(law, static_penetration(true_law, force));
  ParameterError error{.object = object,
                       .name = "contact.force",
                       .unit = "N",
                       .estimate = ParameterValue{estimated},
                       .truth = force};
  compare(error);
  return error;
}

/// The restitution of impacts at the speed of the measured ones; the truth by the true law.
std::optional<ParameterError> restitution_error(const std::string& object,
                                                const ObjectParameters* truth,
                                                const ObjectParameters& estimate) {
  if (!estimate.contact_restitution) return std::nullopt;
  ParameterError error{.object = object,
                       .name = "contact.restitution",
                       .unit = "",
                       .estimate = estimate.contact_restitution};
  const bool is_known = truth && truth->contact_damping && estimate.contact_impact_speed;
  const std::optional<HuntCrossley> law = is_known ? contact_law_of(*truth) : std::nullopt;
  if (law && law->exponent > 1.0) {  // a linear damping has another unit
    // It does not depend on the mass.
    const Impact impact = simulate_impact(*law, 1.0, estimate.contact_impact_speed->value);
    if (impact.has_separated) error.truth = impact.restitution;
  }
  compare(error);
  return error;
}

std::vector<ParameterError> errors_of(const std::string& object, const ObjectParameters* truth,
                                      const ObjectParameters& estimate) {
  std::vector<ParameterError> errors;
  for (const Kind& kind : kKinds) {
    ParameterError error{.object = object, .name = kind.name, .unit = kind.unit};
    error.estimate = estimate.*kind.member;
    const std::vector<std::string>& given = estimate.sources.given;
    if (truth && truth->*kind.member) error.truth = (truth->*kind.member)->value;
    if (!error.estimate && !error.truth) continue;
    const bool is_mass = kind.member == &ObjectParameters::mass;
    // Files of older versions do not state what was given: there, a weighed mass has no std.
    error.is_given = std::find(given.begin(), given.end(), kind.name) != given.end() ||
                     (is_mass && error.estimate && !error.estimate->std);
    if (truth && !error.is_given && (!kind.depends_on_exponent || same_exponent(*truth, estimate)))
      compare(error);
    errors.push_back(error);
  }
  if (auto restitution = restitution_error(object, truth, estimate)) {
    errors.push_back(*std::move(restitution));
  }
  if (truth) {
    if (auto force = contact_force_error(object, *truth, estimate)) errors.push_back(*force);
  }
  return errors;
}

}  // namespace

std::vector<ParameterError> parameter_errors(const ParameterTable& truth,
                                             const ParameterTable& estimate) {
  std::vector<ParameterError> errors;
  for (const auto& [object, parameters] : estimate) {
    const auto true_parameters = truth.find(object);
    const auto more = errors_of(
        object, true_parameters == truth.end() ? nullptr : &true_parameters->second, parameters);
    errors.insert(errors.end(), more.begin(), more.end());
  }
  return errors;
}

}  // namespace pcavr
