// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/told_parameters.hpp"

#include <cmath>
#include <initializer_list>

namespace pcavr {
namespace {

constexpr double kWorthTelling = 0.03;
// Numbers of a group that is told stay out where they are as they were.
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

bool differs(const ObjectParameters& now, const ObjectParameters& told, Field field, double share) {
  if (!(now.*field)) return false;
  if (!(told.*field)) return true;
  const double scale = std::abs((told.*field)->value);
  return std::abs((now.*field)->value - (told.*field)->value) > share * scale;
}

bool collect(const ObjectParameters& now, const ObjectParameters& told,
             std::initializer_list<Field> fields, ObjectParameters& news) {
  bool is_news = false;
  for (const Field field : fields) is_news = is_news || differs(now, told, field, kWorthTelling);
  if (!is_news) return false;
  for (const Field field : fields) {
    if (differs(now, told, field, kSame)) news.*field = now.*field;
  }
  return true;
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
  result.has_contact = collect(now, told, kContactFields, result.contact);
  result.has_friction = collect(now, told, kFrictionFields, result.friction);
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
