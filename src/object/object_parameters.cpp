// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/object/object_parameters.hpp"

namespace pcavr {

std::optional<HuntCrossley> contact_law_of(const ObjectParameters& known) {
  if (!known.contact_stiffness) return std::nullopt;
  HuntCrossley contact_law;
  contact_law.stiffness = known.contact_stiffness->value;
  if (known.contact_damping) contact_law.damping = known.contact_damping->value;
  if (known.contact_exponent) contact_law.exponent = known.contact_exponent->value;
  return contact_law;
}

}  // namespace pcavr
