// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/sent_parameters.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "pcavr/physics/contact/hunt_crossley.hpp"

namespace pcavr {
namespace {

// Friction parameters with a smaller relative change are omitted where friction is sent.
constexpr double kSame = 1e-3;

using Field = std::optional<ParameterValue> ObjectParameters::*;
constexpr std::initializer_list<Field> kContactFields{&ObjectParameters::contact_stiffness,
                                                      &ObjectParameters::contact_damping,
                                                      &ObjectParameters::contact_exponent};
constexpr std::initializer_list<Field> kFrictionFields{
    &ObjectParameters::mass,
    &ObjectParameters::limiting_static_friction,
    &ObjectParameters::sliding_friction_coefficient,
    &ObjectParameters::viscous_friction,
    &ObjectParameters::friction_radius,
    &ObjectParameters::tool_friction_coefficient};

bool differs(const ObjectParameters& now, const ObjectParameters& acknowledged, Field field,
             double tolerance) {
  if (!(now.*field)) return false;
  if (!(acknowledged.*field)) return true;
  const double scale = std::abs((acknowledged.*field)->value);
  return std::abs((now.*field)->value - (acknowledged.*field)->value) > tolerance * scale;
}

/// The parameters that differ, also from those in flight, which may arrive in the meantime.
ObjectParameters changed_parameters(const ObjectParameters& now,
                                    const ObjectParameters& acknowledged,
                                    const ObjectParameters* in_flight,
                                    std::initializer_list<Field> fields) {
  ObjectParameters result;
  for (const Field field : fields) {
    const bool is_in_flight = in_flight && in_flight->*field;
    if (differs(now, acknowledged, field, kSame) ||
        (is_in_flight && differs(now, *in_flight, field, kSame))) {
      result.*field = now.*field;
    }
  }
  return result;
}

HuntCrossley law_of(const ObjectParameters& parameters) {
  return {.stiffness = parameters.contact_stiffness->value,
          .damping = parameters.contact_damping->value,
          .exponent = parameters.contact_exponent->value};
}

/// Stiffness and exponent are correlated: compares the resulting force.
bool has_different_force(const ObjectParameters& now, const ObjectParameters& acknowledged,
                         const MessageOptions& options) {
  const double max_force =
      std::max(now.limiting_static_friction->value, options.min_compared_force);
  for (const double ratio : {0.3, 1.0}) {
    const double penetration = static_penetration(law_of(now), ratio * max_force);
    for (const double rate : {0.0, options.compared_rate}) {
      const double force = unclamped_contact_force(law_of(now), penetration, rate);
      const double old_force = unclamped_contact_force(law_of(acknowledged), penetration, rate);
      if (std::abs(old_force - force) > options.min_parameter_change * force) return true;
    }
  }
  return false;
}

/// The surface is a form of degree four: of the load the relative change is a quarter of the
/// form's.
bool has_different_surface(const ObjectParameters& now, const ObjectParameters& acknowledged,
                           double tolerance) {
  if (!now.limit_surface) return false;
  if (!acknowledged.limit_surface) return true;
  double largest = 0.0, change = 0.0;
  for (std::size_t i = 0; i < now.limit_surface->coefficients.size(); ++i) {
    const double coefficient = now.limit_surface->coefficients[i];
    largest = std::max(largest, std::abs(coefficient));
    change = std::max(change, std::abs(coefficient - acknowledged.limit_surface->coefficients[i]));
  }
  return change > 4.0 * tolerance * largest;
}

Eigen::Vector3d surface_offset(const ObjectParameters& parameters) {
  return parameters.contact_surface_offset.value_or(Eigen::Vector3d::Zero());
}

}  // namespace

ObjectParameters sent_parameters(const BodyPhysics& physics, double gravity) {
  const FrictionParameters& friction = physics.friction;
  ObjectParameters sent;
  sent.mass = ParameterValue{friction.mass};
  sent.limiting_static_friction =
      ParameterValue{friction.limiting_force, friction.limiting_force_std};
  sent.sliding_friction_coefficient =
      ParameterValue{friction.coulomb_force / (friction.mass * gravity)};
  sent.viscous_friction = ParameterValue{friction.viscous};
  sent.contact_stiffness = ParameterValue{physics.contact.stiffness};
  sent.contact_damping = ParameterValue{physics.contact.damping};
  sent.contact_exponent = ParameterValue{physics.contact.exponent};
  sent.friction_radius = ParameterValue{physics.friction_radius};
  sent.tool_friction_coefficient = ParameterValue{physics.tool_friction};
  sent.limit_surface = physics.limit_surface;
  return sent;
}

ParameterDifference difference(const ObjectParameters& now, const ObjectParameters& acknowledged,
                               const ObjectParameters* in_flight, const MessageOptions& options) {
  ParameterDifference result;
  const auto has_other_surface_than = [&](const ObjectParameters& sent) {
    return (surface_offset(now) - surface_offset(sent)).norm() > options.min_pose_error;
  };
  const bool has_other_surface =
      has_other_surface_than(acknowledged) ||
      (in_flight && in_flight->contact_surface_offset && has_other_surface_than(*in_flight));
  result.has_contact = has_other_surface || has_different_force(now, acknowledged, options);
  if (result.has_contact) {
    // Whole: the exponent that another law has brought there is none of this stiffness.
    for (const Field field : kContactFields) result.contact.*field = now.*field;
  }
  // Zero where an earlier one no longer holds.
  if (has_other_surface) result.contact.contact_surface_offset = surface_offset(now);
  for (const Field field : kFrictionFields) {
    result.has_friction =
        result.has_friction || differs(now, acknowledged, field, options.min_parameter_change);
  }
  if (result.has_friction) {
    result.friction = changed_parameters(now, acknowledged, in_flight, kFrictionFields);
  }
  if (has_different_surface(now, acknowledged, options.min_parameter_change)) {
    result.friction.limit_surface = now.limit_surface;
    result.has_friction = true;
  }
  return result;
}

ObjectParameters parameters_to_send(const ParameterDifference& changed, CorrectionCase which,
                                    bool forces_agree, const MessageOptions& options) {
  const bool is_one_group = options.parameters_by_force && which == CorrectionCase::both_sliding;
  ObjectParameters sent;
  if (changed.has_contact && !(is_one_group && forces_agree)) overwrite(sent, changed.contact);
  if (changed.has_friction && !(is_one_group && !forces_agree)) overwrite(sent, changed.friction);
  return sent;
}

void overwrite(ObjectParameters& parameters, const ObjectParameters& changed) {
  for (const auto& fields : {kContactFields, kFrictionFields}) {
    for (const Field field : fields) {
      if (changed.*field) parameters.*field = changed.*field;
    }
  }
  if (changed.limit_surface) parameters.limit_surface = changed.limit_surface;
  if (changed.contact_surface_offset) {
    parameters.contact_surface_offset = changed.contact_surface_offset;
  }
}

bool is_empty(const ObjectParameters& parameters) {
  for (const auto& fields : {kContactFields, kFrictionFields}) {
    for (const Field field : fields) {
      if (parameters.*field) return false;
    }
  }
  return !parameters.limit_surface && !parameters.contact_surface_offset;
}

}  // namespace pcavr
