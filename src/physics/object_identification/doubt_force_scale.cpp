// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <optional>

#include <fmt/core.h>

#include "pcavr/physics/inputs/force_scale.hpp"

#include "physics/object_identification/identification_steps.hpp"
#include "physics/object_identification/widen_stds.hpp"

namespace pcavr {

void doubt_force_scale(const IdentifiableObject& object, const ObjectParameters& known,
                       ObjectIdentification& result) {
  if (!object.mass) return;
  const std::optional<ScaleDoubt> doubt =
      doubt_of_scale({object.name, *object.mass, result.sliding.mass});
  if (!doubt) return;
  const double share = std::abs(1.0 - 1.0 / doubt->doubted_factor);
  widen_new(
      std::array{&ObjectParameters::inertial_mass, &ObjectParameters::limiting_static_friction,
                 &ObjectParameters::sliding_friction_coefficient,
                 &ObjectParameters::viscous_friction, &ObjectParameters::contact_stiffness,
                 &ObjectParameters::contact_damping, &ObjectParameters::loading_rate},
      share, known, result.parameters);
  widen_sliding_forces(share, result.parameters);
  if (const auto& exponent = result.parameters.contact_exponent) {
    double& depth_std = result.penetration.relative_std;  // at a force that is wrong by the factor
    if (depth_std > 0.0) depth_std = std::hypot(depth_std, share / exponent->value);
  }
  result.notes.push_back(fmt::format(
      "the mass by force and acceleration is {:.3g} times the given one: the stds of friction and "
      "stiffness contain that the force, or the given mass, may be wrong by a factor of {:.3g}",
      doubt->factor, doubt->doubted_factor));
}

}  // namespace pcavr
