// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/object/contact_units.hpp"

#include "pcavr/base/core/decimal.hpp"

namespace pcavr {

std::string_view contact_law_name(double exponent, bool has_mass) noexcept {
  if (exponent == 1.0 && has_mass) return "mass_damper_spring";
  return exponent == 1.0 ? "kelvin_voigt" : "hunt_crossley";
}

std::string damping_unit(double exponent) {
  return exponent == 1.0 ? "N s/m" : "N s/m^" + shortest_decimal(exponent + 1.0);
}

}  // namespace pcavr
