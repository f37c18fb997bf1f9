// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "pcavr/identification/friction_posterior.hpp"
#include "pcavr/pipeline/identify.hpp"

#include "identify_parts.hpp"

namespace pcavr {

/// By which a contact is compressed, and so the object's motion follows from the tip's.
struct ContactCompliance {
  std::optional<HuntCrossley> law = {};  ///< without one, that of each push's own loading
  double std = 0.0;                      ///< relative, under the force of sliding
  double damping_std = 0.0;              ///< [s/m] of damping over stiffness
};

/// What is known of an object's support, beside its CAD model.
struct KnownSupport {
  std::optional<double> friction_radius = {};  ///< [m]
  std::optional<double> weight = {};           ///< [N]
};

/// The power balances of all pushes in which the object slid, however slowly. Where the object was
/// tracked, its rotation and its motion along the touched face count; else it moves as the tip
/// does, less the contact's compression. Samples are one smoothing apart. The support is that of
/// the CAD body's lowest face, scaled to the friction radius [m] where that is known: three feet
/// near the centre of mass dissipate less in a rotation than the whole face. The push's height over
/// the support moves its pressure ahead, by the weight.
[[nodiscard]] std::vector<FrictionSample> friction_samples(
    const std::vector<IdentifiedContact*>& pushes, const ContactCompliance& compliance,
    const BodyMotion& body, const PathView& tip, double tool_radius,
    const KnownSupport& known = {});

}  // namespace pcavr
