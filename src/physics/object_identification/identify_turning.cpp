// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "pcavr/physics/object_identification/object_identification.hpp"
#include "pcavr/physics/turning/support.hpp"
#include "pcavr/physics/turning/tool_friction.hpp"
#include "pcavr/physics/turning/turning.hpp"

namespace pcavr {
namespace {

constexpr double kToDegrees = 180.0 / std::numbers::pi;

}  // namespace

void identify_turning_of(std::vector<Contact>& contacts, std::size_t object, const BodyMotion& body,
                         const PathView& tip, double tool_radius, const ParameterValue& viscous,
                         const IdentificationOptions& options, ObjectIdentification& result) {
  if (body.tracked.empty()) return;
  std::optional<double> weight;
  if (const auto& mass = result.parameters.mass) weight = mass->value * options.sliding.gravity;
  SamplesOfPushes pushes;
  for (const Contact* push : contacts_of(contacts, object, false)) {
    std::vector<PushSample> samples = turning_samples(*push, body, tip, tool_radius, weight);
    if (!samples.empty()) pushes.push_back(std::move(samples));
  }
  result.turning = joined(pushes);
  const TurningFriction found = identify_turning(pushes, body, viscous, options.limit_surface);
  result.surface = found.surface;
  result.friction_radius = found.radius;
  if (found.radius) {
    const Support even(body.model, body.tracked.front().T_base_object);
    result.turning = without_viscous_load(
        std::move(result.turning), even.scaled(found.radius->value / even.radius()), viscous.value);
    result.parameters.friction_radius = found.radius;
    result.parameters.sources.pushes["friction_radius"] = static_cast<int>(pushes.size());
  }
  if (found.surface.status == LimitSurfaceFitStatus::fitted) {
    result.parameters.limit_surface = found.surface.surface;
  }
}

void identify_tool_friction_of(const std::vector<Contact>& contacts, std::size_t object,
                               const BodyMotion& body, const BodySurface& surface,
                               const PathView& tip, double tool_radius,
                               ObjectIdentification& result) {
  std::vector<std::vector<RubbedPart>> parts;
  for (const Contact& contact : contacts) {
    if (contact.object != object || !contact.left_out.empty() || contact.impact) continue;
    parts.push_back(rubbed_parts(contact, body, surface, tip, tool_radius));
  }
  const std::optional<ToolFriction> found = tool_friction_of(parts, body.tracked);
  if (!found) return;
  result.parameters.tool_friction_coefficient = found->coefficient;
  if (found->turn.doubt() > 0.0) {
    result.notes.push_back(fmt::format(
        "the tip slides at {:.2g} +- {:.2g} degrees to the mesh's faces: the tracked frame may be "
        "turned against the mesh's, and the friction of the tool is uncertain by that angle",
        kToDegrees * std::abs(found->turn.turn), kToDegrees * found->turn.std));
  }
  result.tool_friction_contacts = found->contacts;
  result.parameters.sources.pushes["tool_friction_coefficient"] = found->contacts;
}

}  // namespace pcavr
