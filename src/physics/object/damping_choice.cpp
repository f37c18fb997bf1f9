// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/object/damping_choice.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "pcavr/physics/contact/impact.hpp"

namespace pcavr {
namespace {

/// Relative; 0 where it is not known.
double relative_std(const ParameterValue& value) {
  return value.std && value.value > 0.0 ? *value.std / value.value : 0.0;
}

/// Relative std of g(c) that follows from the std of c.
double relative_std_of_factor(DampingLaw law, const ParameterValue& restitution) {
  if (!restitution.std) return 0.0;
  const auto at = [&](double change) {
    return damping_factor(law, std::clamp(restitution.value + change, 1e-3, 1.0));
  };
  const double factor = at(0.0);
  if (!(factor > 0.0)) return 0.0;
  return 0.5 * std::abs(at(-*restitution.std) - at(*restitution.std)) / factor;
}

/// Why the damping can't follow from a restitution; empty: it can.
const char* obstacle(const ObjectParameters& known) {
  if (!known.contact_restitution || !known.contact_impact_speed)
    return "its restitution is not known";
  if (!known.contact_stiffness) return "its stiffness is not known";
  if (!known.contact_exponent || known.contact_exponent->value <= 1.0) {
    return "its law is linear: the damping laws are for hunt_crossley";
  }
  return nullptr;
}

}  // namespace

ChosenDampingLaw choose_damping_law(std::optional<DampingLaw> option, double restitution) {
  if (option) {
    return {*option, *option == DampingLaw::exact ? "by the exact relation" : "as chosen"};
  }
  // At a restitution of 1 every law is exact, and the criterion has nothing to compare.
  const DampingScore best = best_published_damping_law(std::min(restitution, 0.999));
  return {best.law, fmt::format("the published law with the smallest error of the restitution, "
                                "{:+.1f} % at {:.2f} [paper B, eq. 12]",
                                100.0 * best.relative_error, restitution)};
}

std::vector<std::string> apply_damping_law(std::optional<DampingLaw> option,
                                           ParameterTable& parameters) {
  std::vector<std::string> notes;
  for (auto& [name, known] : parameters) {
    if (const char* reason = obstacle(known)) {
      notes.push_back(name + ": contact damping as in the file, " + reason);
      continue;
    }
    const ParameterValue& restitution = *known.contact_restitution;
    const ParameterValue& speed = *known.contact_impact_speed;
    const ParameterValue& stiffness = *known.contact_stiffness;
    const ChosenDampingLaw chosen = choose_damping_law(option, restitution.value);
    const double value =
        hunt_crossley_damping(chosen.law, stiffness.value, restitution.value, speed.value);
    const double share = std::hypot(relative_std_of_factor(chosen.law, restitution),
                                    relative_std(speed), relative_std(stiffness));
    known.contact_damping = ParameterValue{value, value * share};
    known.contact_damping_law = chosen.law;
    notes.push_back(fmt::format("{}: contact damping {:.4g} N s/m^{:.4g} by {}, {}", name, value,
                                known.contact_exponent->value + 1.0, name_of(chosen.law),
                                chosen.reason));
  }
  return notes;
}

}  // namespace pcavr
