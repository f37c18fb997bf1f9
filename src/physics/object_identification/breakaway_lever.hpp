// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/base/core/options.hpp"
#include "pcavr/physics/object_identification/object_identification.hpp"

namespace pcavr {

/// Lever arm [m] of the force at `t` [s] about the centre of mass of a tracked object: a tip that
/// holds on to a face may push it obliquely, and the object turns before it slides. 0 without
/// tracking or breakaway.
[[nodiscard]] double lever_at(double t, const Contact& push, const BodyMotion& body,
                              const PathView& tip, double tool_radius);

/// The time [s] at which an object that breaks away begins to yield: from then on until the peak
/// the force is above Coulomb friction [N]. In an accelerated push the peak comes later, when the
/// object has turned and the force has another direction.
[[nodiscard]] double yield_instant(const Contact& contact, double coulomb);

/// [rad/m] Rotation per travel of a tracked object that breaks away, about its pose before, over
/// its first millimetres. A worn support turns it under a force through its centre of mass, too.
[[nodiscard]] double turning_at_breakaway(const Contact& push, const BodyMotion& body);

/// [m] Friction radius: as identified, or that of even pressure with the std of
/// FrictionPriors::support_size_share; 0 where neither is known.
[[nodiscard]] IdentifiedParameter support_radius(const BodyMotion& body,
                                                 const ObjectParameters& known,
                                                 const FrictionPriors& priors);

/// Limit of a push with the lever arm `lever` [m], as if through the centre of mass: at the
/// breakaway, force F and moment M about the centre are on the limit surface F^2 + (M / r)^2 =
/// F_M^2 [an ellipsoid: Howe & Cutkosky 1996], and M is F times the lever. `radius` r > 0, whose
/// error all pushes share.
[[nodiscard]] LimitOfMotion limit_with_moment(const LimitOfMotion& limit, double lever,
                                              const IdentifiedParameter& radius);

}  // namespace pcavr
