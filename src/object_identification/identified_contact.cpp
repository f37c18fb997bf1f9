// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstddef>
#include <vector>

#include "pcavr/object_identification/object_identification.hpp"

namespace pcavr {

ParameterValue as_value(const IdentifiedParameter& parameter) {
  return {parameter.value, parameter.std};
}

std::vector<IdentifiedContact*> contacts_of(std::vector<IdentifiedContact>& contacts,
                                            std::size_t object, bool presses) {
  std::vector<IdentifiedContact*> chosen;
  for (IdentifiedContact& contact : contacts) {
    const bool is_press = contact.episode.kind == ContactKind::press;
    const bool is_usable = contact.left_out.empty() && !contact.episode.impact;
    if (contact.object == object && is_usable && is_press == presses) {
      chosen.push_back(&contact);
    }
  }
  return chosen;
}

bool is_centred(const IdentifiedContact* push) { return std::abs(push->lever) <= kMaxCentredLever; }

double curvature_std(const ContactIdentification& presses, const ContactFit& fit, double force) {
  const ContactFit& curved = presses.hunt_crossley;
  const bool is_linear = fit.regressor == ContactRegressor::mass_damper_spring;
  if (!is_linear || !curved.is_valid) return 0.0;
  const double linear_depth = force / fit.stiffness.value;
  const double depth = std::pow(force / curved.stiffness.value, 1.0 / curved.exponent.value);
  return std::abs(std::log(depth / linear_depth));
}

}  // namespace pcavr
