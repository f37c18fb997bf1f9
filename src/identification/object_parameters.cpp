// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/identification/object_parameters.hpp"

namespace pcavr {

std::optional<Compliance> compliance_of(const ObjectParameters& known) {
  if (!known.contact_stiffness) return std::nullopt;
  Compliance compliance;
  compliance.stiffness = known.contact_stiffness->value;
  if (known.contact_damping) compliance.damping = known.contact_damping->value;
  if (known.contact_exponent) compliance.exponent = known.contact_exponent->value;
  return compliance;
}

}  // namespace pcavr
