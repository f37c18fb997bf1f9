// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Online identification of what tracking shows: how the object turns, and how the tip slips.
#include <cmath>
#include <optional>

#include "pcavr/physics/turning/support.hpp"
#include "pcavr/physics/turning/turning.hpp"

#include "teleoperation/teleop/online_identification.hpp"

namespace pcavr {
namespace {

// Pushes that turned the object, for a radius: the std is by leaving one out.
constexpr int kMinTurningPushes = 3;
// Stds within which the radius of few pushes is that of even pressure, which the prediction has.
constexpr double kSameRadius = 2.0;

}  // namespace

void OnlineIdentification::accept_tool_friction(const ObjectIdentification& found) {
  const std::optional<ParameterValue>& friction = found.parameters.tool_friction_coefficient;
  if (found.tool_friction_contacts > 0) {
    accept(&ObjectParameters::tool_friction_coefficient, *friction);
  } else if (suspected_turn_ > 0.0) {
    // A force that is turned looks like it: what was learned before that was seen is withdrawn.
    has_changed_ |= known_.tool_friction_coefficient.has_value();
    known_.tool_friction_coefficient = friction;
  }
}

Pose OnlineIdentification::first_pose() const {
  for (const auto& contact : contacts_) {
    if (!contact->tracked.empty()) return contact->tracked.front().T_base_object;
  }
  return object_->T_base_object;
}

void OnlineIdentification::accept_radius(const ObjectIdentification& found) {
  if (!found.friction_radius) return;
  const ParameterValue& radius = *found.parameters.friction_radius;
  if (*radius.std > options_.max_radius_std * radius.value) return;
  const auto pushes = found.parameters.sources.pushes.find("friction_radius");
  if (pushes == found.parameters.sources.pushes.end() || pushes->second < kMinTurningPushes) return;
  const Pose T_base_object = first_pose();
  const double even = Support(object_->model, T_base_object).radius();
  if (std::abs(radius.value - even) <= kSameRadius * *radius.std) return;
  if (!accept(&ObjectParameters::friction_radius, radius)) return;
  known_.limit_surface = found.surface.status == LimitSurfaceFitStatus::fitted
                             ? found.parameters.limit_surface
                             : surface_of_support(object_->model, T_base_object, radius.value);
}

}  // namespace pcavr
