// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/base/core/gravity.hpp"
#include "pcavr/physics/object/object_parameters.hpp"
#include "pcavr/physics/prediction/body_physics.hpp"
#include "pcavr/teleoperation/teleop/options.hpp"
#include "pcavr/teleoperation/teleop/run_teleop.hpp"

namespace pcavr {

/// All parameters of a completed body, as sent to another site, which then needs no defaults.
[[nodiscard]] ObjectParameters sent_parameters(const BodyPhysics& physics,
                                               double gravity = kStandardGravity);

/// The parameters in `now` that another site does not have yet. A group is omitted as a whole if it
/// changes its effect by less than `min_parameter_change`: the friction parameters, and the contact
/// force at the penetrations that the object's friction allows.
struct ParameterDifference {
  ObjectParameters contact;   ///< stiffness, damping, exponent, surface offset
  ObjectParameters friction;  ///< all the others
  bool has_contact = false;
  bool has_friction = false;
};
/// `now` and `acknowledged` are complete, as by sent_parameters. `in_flight`, or null: sent and not
/// acknowledged yet. A surface offset may return to what was acknowledged before it arrived.
[[nodiscard]] ParameterDifference difference(const ObjectParameters& now,
                                             const ObjectParameters& acknowledged,
                                             const ObjectParameters* in_flight,
                                             const MessageOptions& options = {});

/// Parameters that a correction of that case contains: every group that has changed. With
/// `parameters_by_force`, in case 1.3 as in paper C only one: friction where the forces agree, else
/// the contact.
[[nodiscard]] ObjectParameters parameters_to_send(const ParameterDifference& changed,
                                                  CorrectionCase which, bool forces_agree,
                                                  const MessageOptions& options);

/// Replaces each of `parameters` that is set in `changed`.
void overwrite(ObjectParameters& parameters, const ObjectParameters& changed);
[[nodiscard]] bool is_empty(const ObjectParameters& parameters);

}  // namespace pcavr
