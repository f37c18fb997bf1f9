// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pcavr/physics/contact/damping.hpp"
#include "pcavr/physics/object/object_parameters.hpp"

namespace pcavr {

struct ChosenDampingLaw {
  DampingLaw law = DampingLaw::exact;
  std::string reason;  ///< for the user
};

/// The law that `option` names; where it is empty, the published one with the smallest error at
/// this restitution, in (0, 1) [paper B, eq. 12].
[[nodiscard]] ChosenDampingLaw choose_damping_law(std::optional<DampingLaw> option,
                                                  double restitution);

/// Replaces the contact damping of every object whose restitution c and impact speed v are known by
/// that of the chosen law (see choose_damping_law): lambda = g(c) k / v, with k the known
/// stiffness, of Hunt-Crossley contacts. The damping's std follows from those of c, v and k.
/// Returns a line about each object for the user, also where the damping stays as it is.
[[nodiscard]] std::vector<std::string> apply_damping_law(std::optional<DampingLaw> option,
                                                         ParameterTable& parameters);

}  // namespace pcavr
