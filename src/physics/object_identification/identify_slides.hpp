// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pcavr/physics/identification/friction_posterior.hpp"
#include "pcavr/physics/object_identification/object_identification.hpp"

namespace pcavr {

/// The power balances of all pushes in which the object slid, however slowly. Where the object was
/// tracked, its rotation and its motion along the touched face count; else it moves as the tip
/// does, less the contact's compression. Samples are one smoothing apart. The support is that of
/// the CAD body's lowest face, scaled to the friction radius [m] where that is known: three feet
/// near the centre of mass dissipate less in a rotation than the whole face. The push's height over
/// the support moves its pressure ahead, by the weight. What pushes have shown before is used
/// again.
[[nodiscard]] std::vector<FrictionSample> friction_samples(const std::vector<Contact*>& pushes,
                                                           const ContactCompliance& compliance,
                                                           const BodyMotion& body,
                                                           const PathView& tip, double tool_radius,
                                                           const KnownSupport& known = {});

}  // namespace pcavr
