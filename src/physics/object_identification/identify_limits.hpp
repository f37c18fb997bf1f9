// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pcavr/physics/identification/parameter.hpp"
#include "pcavr/physics/object_identification/object_identification.hpp"

namespace pcavr {

/// The pushes that say F_M: those of `centred`, which are through the centre of mass at their peak,
/// that already are so when the object begins to yield. Where there is none, all that are slow: at
/// their peak, force and moment together are at the limit. `radius`: the friction radius [m], if it
/// is known.
[[nodiscard]] std::vector<Contact*> pushes_at_limit(
    const std::vector<Contact*>& all, std::vector<Contact*> centred, const BodyMotion& body,
    const PathView& tip, double tool_radius, const IdentifiedParameter& radius,
    const IdentificationOptions& options, ObjectIdentification& result);

/// F_M of each push, and of all that count: with the scatter between pushes.
void find_limits(const std::vector<Contact*>& pushes, const ContactCompliance& compliance,
                 const IdentifiedParameter& radius, const IdentificationOptions& options,
                 ObjectIdentification& result);

}  // namespace pcavr
