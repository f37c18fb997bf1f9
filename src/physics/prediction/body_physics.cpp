// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/prediction/body_physics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pcavr/base/core/check.hpp"
#include "pcavr/physics/contact/hunt_crossley.hpp"

#include "physics/prediction/support_patch.hpp"

namespace pcavr {
namespace {

constexpr double kSteep = 0.5;  // cosine of 60 degrees: where the y axis is the flatter one

void require_not_negative(const std::optional<ParameterValue>& given) {
  if (given) PCAVR_REQUIRE(std::isfinite(given->value) && given->value >= 0.0, given->value);
}
void require_positive(const std::optional<ParameterValue>& given) {
  if (given) PCAVR_REQUIRE(std::isfinite(given->value) && given->value > 0.0, given->value);
}

void require_physical(const ObjectParameters& known) {
  require_positive(known.mass);
  if (const auto& limit = known.limiting_static_friction; limit && limit->std) {
    PCAVR_REQUIRE(std::isfinite(*limit->std) && *limit->std >= 0.0);
  }
  require_not_negative(known.limiting_static_friction);
  require_not_negative(known.limiting_static_friction_scatter);
  require_not_negative(known.sliding_friction_coefficient);
  require_not_negative(known.viscous_friction);
  require_positive(known.contact_stiffness);
  require_not_negative(known.contact_damping);
  if (known.contact_exponent) {
    PCAVR_REQUIRE(known.contact_exponent->value >= 1.0, known.contact_exponent->value);
  }
  require_positive(known.contact_mass);
  require_positive(known.friction_radius);
  require_not_negative(known.tool_friction_coefficient);
}

/// The given value, or a default that is recorded by name.
class Completion {
 public:
  explicit Completion(std::vector<std::string>& assumed) : assumed_(assumed) {}
  double operator()(const std::optional<ParameterValue>& given, double default_value,
                    const char* name) const {
    if (given) return given->value;
    assumed_.emplace_back(name);
    return default_value;
  }

 private:
  std::vector<std::string>& assumed_;
};

/// [N] Coulomb friction where no coefficient is known: what pushes have shown of the whole friction
/// at the speed of the smallest std, else by the limiting friction.
double default_coulomb(const ObjectParameters& known, double weight,
                       const PhysicsDefaults& defaults) {
  const auto& limit = known.limiting_static_friction;
  if (!known.sliding_force.empty()) {
    const auto best = std::min_element(
        known.sliding_force.begin(), known.sliding_force.end(),
        [](const SlidingForce& a, const SlidingForce& b) { return a.std < b.std; });
    return limit ? std::min(best->force, limit->value) : best->force;
  }
  return limit ? limit->value / defaults.static_to_kinetic_ratio
               : defaults.sliding_coefficient * weight;
}

FrictionParameters complete_friction(const ObjectParameters& known, double volume, double gravity,
                                     const PhysicsDefaults& defaults, const Completion& value_of) {
  const auto& limit = known.limiting_static_friction;
  const auto& coefficient = known.sliding_friction_coefficient;
  double mass = defaults.density * volume;
  if (limit && coefficient && limit->value > 0.0 && coefficient->value > 0.0) {
    mass = limit->value / (defaults.static_to_kinetic_ratio * coefficient->value * gravity);
  }
  FrictionParameters friction;
  friction.mass = value_of(known.mass, mass, "mass");
  const double weight = friction.mass * gravity;
  const double default_coefficient = default_coulomb(known, weight, defaults) / weight;
  friction.coulomb_force =
      weight * value_of(coefficient, default_coefficient, "sliding_friction_coefficient");
  friction.limiting_force = value_of(
      limit, defaults.static_to_kinetic_ratio * friction.coulomb_force, "limiting_static_friction");
  const auto& scatter = known.limiting_static_friction_scatter;
  if (scatter) {
    friction.limiting_force_std = scatter->value;
  } else if (limit && limit->std) {
    friction.limiting_force_std = *limit->std;
  }
  friction.viscous = value_of(known.viscous_friction, 0.0, "viscous_friction");
  return friction;
}

HuntCrossley complete_contact(const ObjectParameters& known, const FrictionParameters& friction,
                              const PhysicsDefaults& defaults, const Completion& value_of) {
  HuntCrossley contact;
  // A stiffness without its exponent is in N/m.
  contact.exponent =
      value_of(known.contact_exponent, known.contact_stiffness ? 1.0 : defaults.contact_exponent,
               "contact_exponent");
  // One newton is the scale where there is no friction.
  const double force = std::max(static_friction_limit(friction), 1.0);
  contact.stiffness = value_of(known.contact_stiffness,
                               force / penetration_power(defaults.penetration, contact.exponent),
                               "contact_stiffness");
  const double depth = static_penetration(contact, force);
  const double slope = contact.exponent * force / depth;
  const double damping = 2.0 * defaults.damping_ratio * std::sqrt(slope * friction.mass);
  contact.damping =
      value_of(known.contact_damping,
               damping / contact_damping({.damping = 1.0, .exponent = contact.exponent}, depth),
               "contact_damping");
  return contact;
}

}  // namespace

CompletedPhysics complete_physics(const ObjectParameters& known, const CadModel& model,
                                  const Pose& T_base_object, double gravity,
                                  const PhysicsDefaults& defaults) {
  require_physical(known);
  PCAVR_REQUIRE(gravity > 0.0, gravity);
  PCAVR_REQUIRE(defaults.density > 0.0 && defaults.static_to_kinetic_ratio >= 1.0);
  PCAVR_REQUIRE(defaults.penetration > 0.0 && defaults.contact_exponent >= 1.0);
  CompletedPhysics completed;
  const Completion value_of(completed.assumed);
  BodyPhysics& physics = completed.physics;
  physics.friction = complete_friction(known, model.volume, gravity, defaults, value_of);
  physics.contact = complete_contact(known, physics.friction, defaults, value_of);
  if (known.contact_mass) physics.contact_mass = known.contact_mass->value;
  if (known.contact_surface_offset) {
    physics.surface_offset = T_base_object.rotation() * *known.contact_surface_offset;
  }
  // Whether a steady push sticks and slips is decided by how fast friction falls, the contact's
  // stiffness and its damping: with an assumed one slow pushes would, as few real ones do.
  const bool is_identified = known.limiting_static_friction && known.sliding_friction_coefficient &&
                             known.contact_stiffness && known.contact_damping;
  physics.stribeck_speed = is_identified ? defaults.stribeck_speed : 0.0;
  physics.tool_friction = value_of(known.tool_friction_coefficient, defaults.tool_friction,
                                   "tool_friction_coefficient");
  const detail::SupportPatch patch =
      detail::support_patch(model, T_base_object, defaults.patch_height);
  physics.friction_radius =
      value_of(known.friction_radius, detail::radius_of(patch), "friction_radius");
  physics.limit_surface = known.limit_surface;
  if (!physics.limit_surface) {
    physics.limit_surface =
        detail::surface_of(patch, physics.friction_radius, heading_of(T_base_object));
  }
  return completed;
}

CompletedPhysics complete_immovable_physics(const ObjectParameters& known, const CadModel& model,
                                            const Pose& T_base_object, double gravity,
                                            const PhysicsDefaults& defaults) {
  CompletedPhysics completed = complete_physics(known, model, T_base_object, gravity, defaults);
  std::erase_if(completed.assumed, [](const std::string& name) {
    return !name.starts_with("contact_") && name != "tool_friction_coefficient";
  });
  return completed;
}

double heading_of(const Pose& T_base_object) {
  const Eigen::Matrix3d axes = T_base_object.rotation_matrix();
  const Eigen::Index axis = axes.col(0).head<2>().norm() < kSteep ? 1 : 0;
  return std::atan2(axes(1, axis), axes(0, axis));
}

}  // namespace pcavr
