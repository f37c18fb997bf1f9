// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "pcavr/physics/contact/hunt_crossley.hpp"

#include "physics/object_identification/identification_steps.hpp"

namespace pcavr {
namespace {

constexpr double kMinForceShare = 0.25;  // of the largest force: what the law's std is stated from

/// [-] of ln F, by which `force` is outside of the forces that the law was found by.
double extrapolation(double force, double max_force) {
  const double log_share = std::log(force / max_force);
  return std::max({0.0, log_share, std::log(kMinForceShare) - log_share});
}

}  // namespace

void state_penetration(const ContactFitOptions& options, ObjectIdentification& result) {
  PenetrationFinding& found = result.penetration;
  const std::optional<HuntCrossley> law = contact_law_of(result.parameters);
  if (!law || found.relative_std <= 0.0 || found.max_force <= 0.0) return;
  const auto& limit = result.parameters.limiting_static_friction;
  found.force = limit && result.limit.pushes > 0 ? limit->value : found.max_force;
  found.depth.value = static_penetration(*law, found.force);
  const double exponent_std =
      result.parameters.contact_exponent->std.value_or(options.prior_exponent_std) / law->exponent;
  found.depth.std = found.depth.value *
                    std::hypot(found.relative_std, exponent_std / law->exponent *
                                                       extrapolation(found.force, found.max_force));
  found.depth.is_excited = found.depth.value > 2.0 * found.depth.std;
}

}  // namespace pcavr
