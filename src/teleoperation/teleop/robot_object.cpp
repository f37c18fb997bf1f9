// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/robot_object.hpp"

#include <memory>

#include "teleoperation/teleop/sent_parameters.hpp"

namespace pcavr {
namespace {

OnlineIdentification identification_of(const TeleopObject& object, const LearningOptions& options,
                                       double tool_radius) {
  return {std::make_shared<const IdentifiableObject>(
              IdentifiableObject{.name = object.name,
                                 .model = object.model,
                                 .T_base_object = object.T_base_object,
                                 .is_movable = object.is_movable}),
          object.parameters, tool_radius, options};
}

/// What the operator's site has at the start.
ObjectParameters acknowledged_at_start(const TeleopObject& object, const BodyPhysics& assumed,
                                       double gravity) {
  ObjectParameters parameters = sent_parameters(assumed, gravity);
  parameters.contact_surface_offset = object.parameters.contact_surface_offset;
  return parameters;
}

}  // namespace

RobotObject::RobotObject(const TeleopObject& object, const BodyPhysics& assumed,
                         const TeleopOptions& options, const SensorProperties& sensors,
                         double tool_radius, double start)
    : gravity_(options.gravity()),
      unknown_objects_(options.unknown_objects),
      limit_surface_(assumed.limit_surface),
      pose_(object, options, sensors, tool_radius, start),
      corrections_(
          CorrectionSwitch(options.correction_switch, sensors.enter_force, options.round_trip()),
          acknowledged_at_start(object, assumed, gravity_)),
      knowledge_(identification_of(object, options.learning, tool_radius), options.learning) {
  unknown_objects_.stribeck_speed = assumed.stribeck_speed;
}

void RobotObject::forget_learned() {
  knowledge_.forget();
  pose_.forget_contacts();
}

BodyPhysics RobotObject::physics_with(const ObjectParameters& parameters) const {
  const TeleopObject& source = pose_.source();
  return complete_physics(parameters, source.model, source.T_base_object, gravity_,
                          unknown_objects_)
      .physics;
}

BodyPhysics RobotObject::physics() const {
  ObjectParameters estimate = knowledge_.current().conservative_estimate();
  if (!estimate.limit_surface) estimate.limit_surface = limit_surface_;
  BodyPhysics physics = physics_with(estimate);
  if (const auto offset = pose_.surface_offset(physics.contact, knowledge_.parameters())) {
    physics.surface_offset = pose_.source().T_base_object.rotation() * *offset;
  }
  return physics;
}

ObjectParameters RobotObject::parameters() const {
  const BodyPhysics completed = physics();
  ObjectParameters sent = sent_parameters(completed, gravity_);
  sent.contact_surface_offset = pose_.surface_offset(completed.contact, knowledge_.parameters());
  return sent;
}

}  // namespace pcavr
