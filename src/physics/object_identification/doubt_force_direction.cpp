// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include <fmt/core.h>

#include "physics/object_identification/identification_steps.hpp"
#include "physics/object_identification/widen_stds.hpp"

namespace pcavr {
namespace {

/// A turn takes from a force the share 1 - cos of what is along the motion.
double share_of_turn(double suspected_turn) {
  const double cosine = std::max(std::cos(suspected_turn), 0.5);
  return 1.0 / cosine - 1.0;
}

}  // namespace

void doubt_force_direction(double suspected_turn, const ObjectParameters& known,
                           ObjectIdentification& result) {
  if (!(suspected_turn > 0.0)) return;
  const std::string angle =
      fmt::format("up to {:.0f} degrees", suspected_turn * 180.0 / std::numbers::pi);
  if (result.tool_friction_contacts > 0) {
    result.tool_friction_contacts = 0;
    result.parameters.tool_friction_coefficient = known.tool_friction_coefficient;
    result.parameters.sources.pushes.erase("tool_friction_coefficient");
    result.notes.push_back("friction at the tip is not identified: a force that is turned by " +
                           angle + " looks like it; clear up the sensor's turn first");
  }
  if (!result.friction.is_valid && result.limit.pushes == 0) return;
  widen_new(std::array{&ObjectParameters::limiting_static_friction,
                       &ObjectParameters::sliding_friction_coefficient,
                       &ObjectParameters::viscous_friction, &ObjectParameters::friction_radius},
            share_of_turn(suspected_turn), known, result.parameters);
  widen_sliding_forces(share_of_turn(suspected_turn), result.parameters);
  result.notes.push_back("the stds of friction contain what a turn of the force by " + angle +
                         " would change");
}

}  // namespace pcavr
