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
    known_.tool_friction_coefficient = friction;
  }
}

void OnlineIdentification::accept_radius(const ObjectIdentification& found) {
  const std::optional<ParameterValue>& radius = found.friction_radius;
  if (!radius || *radius->std > options_.max_radius_std * radius->value) return;
  const auto pushes = found.parameters.sources.pushes.find("friction_radius");
  if (pushes == found.parameters.sources.pushes.end() || pushes->second < kMinTurningPushes) return;
  const Pose& T_base_object = object_->T_base_object;
  const double even = Support(object_->model, T_base_object).radius();
  if (std::abs(radius->value - even) <= kSameRadius * *radius->std) return;
  if (!accept(&ObjectParameters::friction_radius, *found.parameters.friction_radius)) return;
  known_.limit_surface = found.surface.status == LimitSurfaceFitStatus::fitted
                             ? found.parameters.limit_surface
                             : surface_of_support(object_->model, T_base_object, radius->value);
}

}  // namespace pcavr
