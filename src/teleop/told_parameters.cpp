// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/told_parameters.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace pcavr {
namespace {

constexpr double kWorthTelling = 0.03;
// Numbers of a group that is told stay out where they are as they were.
constexpr double kSame = 1e-3;

constexpr double kMinComparedForce = 1.0;  // [N] below which no contact matters
constexpr double kComparedRate = 0.02;     // [m/s] at which damping is compared

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

bool differs(const ObjectParameters& now, const ObjectParameters& told, Field field, double share) {
  if (!(now.*field)) return false;
  if (!(told.*field)) return true;
  const double scale = std::abs((told.*field)->value);
  return std::abs((now.*field)->value - (told.*field)->value) > share * scale;
}

/// Numbers that are not the same, to be told.
ObjectParameters changed(const ObjectParameters& now, const ObjectParameters& told,
                         std::initializer_list<Field> fields) {
  ObjectParameters news;
  for (const Field field : fields) {
    if (differs(now, told, field, kSame)) news.*field = now.*field;
  }
  return news;
}

double force_at(const ObjectParameters& law, double depth, double rate) {
  const double exponent = law.contact_exponent->value;
  const double power = std::pow(depth, exponent);
  const double drag = law.contact_damping->value * (exponent == 1.0 ? 1.0 : power);
  return law.contact_stiffness->value * power + drag * rate;
}

/// Stiffness and exponent are bound to each other: what counts is the force.
bool feels_different(const ObjectParameters& now, const ObjectParameters& told) {
  const double most = std::max(now.limiting_static_friction->value, kMinComparedForce);
  for (const double share : {0.3, 1.0}) {
    const double depth =
        std::pow(share * most / now.contact_stiffness->value, 1.0 / now.contact_exponent->value);
    for (const double rate : {0.0, kComparedRate}) {
      const double force = force_at(now, depth, rate);
      if (std::abs(force_at(told, depth, rate) - force) > kWorthTelling * force) return true;
    }
  }
  return false;
}

}  // namespace

ObjectParameters told_parameters(const BodyPhysics& physics, double gravity) {
  const FrictionParameters& friction = physics.friction;
  ObjectParameters told;
  told.mass = ParameterValue{friction.mass};
  told.limiting_static_friction =
      ParameterValue{friction.limiting_force, friction.limiting_force_std};
  told.sliding_friction_coefficient =
      ParameterValue{friction.coulomb_force / (friction.mass * gravity)};
  told.viscous_friction = ParameterValue{friction.viscous};
  told.contact_stiffness = ParameterValue{physics.contact.stiffness};
  told.contact_damping = ParameterValue{physics.contact.damping};
  told.contact_exponent = ParameterValue{physics.contact.exponent};
  told.friction_radius = ParameterValue{physics.friction_radius};
  told.tool_friction_coefficient = ParameterValue{physics.tool_friction};
  told.limit_surface = physics.limit_surface;
  return told;
}

ParameterDifference difference(const ObjectParameters& now, const ObjectParameters& told) {
  ParameterDifference result;
  result.has_contact = feels_different(now, told);
  if (result.has_contact) result.contact = changed(now, told, kContactFields);
  for (const Field field : kFrictionFields) {
    result.has_friction = result.has_friction || differs(now, told, field, kWorthTelling);
  }
  if (result.has_friction) result.friction = changed(now, told, kFrictionFields);
  if (now.limit_surface && !told.limit_surface) {
    result.friction.limit_surface = now.limit_surface;
    result.has_friction = true;
  }
  return result;
}

void overwrite(ObjectParameters& parameters, const ObjectParameters& news) {
  for (const auto& fields : {kContactFields, kFrictionFields}) {
    for (const Field field : fields) {
      if (news.*field) parameters.*field = news.*field;
    }
  }
  if (news.limit_surface) parameters.limit_surface = news.limit_surface;
}

bool is_empty(const ObjectParameters& parameters) {
  for (const auto& fields : {kContactFields, kFrictionFields}) {
    for (const Field field : fields) {
      if (parameters.*field) return false;
    }
  }
  return !parameters.limit_surface;
}

}  // namespace pcavr
