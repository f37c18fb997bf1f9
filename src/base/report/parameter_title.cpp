// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/report/parameter_title.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace pcavr {
namespace {

/// Symbols: of F = k dⁿ + λ dⁿ ḋ, and of papers B and C.
constexpr std::array<std::pair<std::string_view, const char*>, 17> kTitles = {
    {{"contact.stiffness", "Contact stiffness k"},
     {"contact.damping", "Contact damping λ"},
     {"contact.exponent", "Contact exponent n"},
     {"contact.mass", "Mass that moves with the tip m"},
     {"contact.penetration", "Penetration by the contact law"},
     {"contact.force", "Elastic force at the true limiting friction"},
     {"restitution", "Restitution c"},
     {"contact.restitution", "Restitution c"},
     {"tool_friction_coefficient", "Friction coefficient of tip and object"},
     {"mass", "Mass M"},
     {"inertial_mass", "Mass by accelerations alone"},
     {"limiting_static_friction", "Limiting friction F_M"},
     {"limiting_static_friction_scatter", "Scatter of F_M from push to push"},
     {"loading_rate", "Loading rate at the limit"},
     {"sliding_friction_coefficient", "Sliding friction coefficient μ"},
     {"viscous_friction", "Viscous friction B"},
     {"friction_radius", "Friction radius"}}};

}  // namespace

std::string parameter_title(std::string_view key) {
  const auto known = std::find_if(kTitles.begin(), kTitles.end(),
                                  [&](const auto& title) { return title.first == key; });
  if (known != kTitles.end()) return known->second;
  std::string words(key);
  std::replace_if(
      words.begin(), words.end(), [](char c) { return c == '_' || c == '.'; }, ' ');
  return words;
}

}  // namespace pcavr
