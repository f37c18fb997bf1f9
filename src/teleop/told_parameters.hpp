// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/core/gravity.hpp"
#include "pcavr/identification/object_parameters.hpp"
#include "pcavr/prediction/body_physics.hpp"

namespace pcavr {

/// The numbers of a completed body as they are told to another site, which then needs no assumption
/// of its own.
[[nodiscard]] ObjectParameters told_parameters(const BodyPhysics& physics,
                                               double gravity = kStandardGravity);

/// What of `now` another site does not have yet; groups are left out whole where they make no
/// difference of 3 % in what they are for: friction's numbers, and the force at the depths that the
/// object's friction lets the tip reach. No hand feels less, and no eye sees it.
struct ParameterDifference {
  ObjectParameters contact;   ///< stiffness, damping, exponent
  ObjectParameters friction;  ///< all the others
  bool has_contact = false;
  bool has_friction = false;
};
/// Both complete, as told_parameters makes them.
[[nodiscard]] ParameterDifference difference(const ObjectParameters& now,
                                             const ObjectParameters& told);

/// Puts every number that `news` holds into `parameters`.
void overwrite(ObjectParameters& parameters, const ObjectParameters& news);
[[nodiscard]] bool is_empty(const ObjectParameters& parameters);

}  // namespace pcavr
