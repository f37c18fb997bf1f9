// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/operator_site.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pcavr/physics/contact/contact_inertia.hpp"

#include "teleoperation/teleop/sent_parameters.hpp"

namespace pcavr {
namespace {

// A correction is for the past: a round trip, and this until its detection [s].
constexpr double kMaxDetectionTime = 1.0;
// Motion of a corrected body that is permitted beyond the correction and the tip's path [m]: the
// rounding of messages, and the contact's deflection.
constexpr double kMotionMargin = 5e-4;

/// Whether a sequence number is newer; the numbers wrap around. Only the last few count as old:
/// more than that may have been lost in a row.
bool is_newer(std::uint8_t sequence, std::uint8_t received) {
  constexpr std::uint8_t kMaxOld = 32;
  return static_cast<std::uint8_t>(received - sequence) >= kMaxOld;
}

}  // namespace

Expected<OperatorSite> OperatorSite::create(const TeleopInput& input,
                                            const std::vector<BodyPhysics>& physics,
                                            const TeleopOptions& options, double start,
                                            const Eigen::Vector3d& p_base_tip) {
  WorldModel model;
  model.static_mesh_base = input.static_mesh_base;
  model.tool_radius = input.tool_radius;
  model.gravity = options.gravity();
  model.options = options.world;
  std::vector<Known> objects;
  for (std::size_t i = 0; i < input.objects.size(); ++i) {
    const TeleopObject& object = input.objects[i];
    model.bodies.push_back({object.model, object.T_base_object, physics[i], object.is_movable});
    ObjectParameters known = sent_parameters(physics[i], options.gravity());
    known.contact_surface_offset = object.parameters.contact_surface_offset;
    objects.push_back({object.model,
                       object.T_base_object,
                       std::move(known),
                       {},
                       object.parameters.contact_mass.value_or(ParameterValue{}).value,
                       physics[i].stribeck_speed});
  }
  Expected<PredictedWorld> world = PredictedWorld::create(std::move(model));
  if (!world) return world.error();
  PredictorOptions predictor = options.predictor;
  predictor.history = std::max(predictor.history, options.round_trip() + kMaxDetectionTime);
  return OperatorSite(Predictor(std::move(*world), start, p_base_tip, predictor),
                      std::move(objects), start, predictor.history, options);
}

void OperatorSite::enqueue(double arrival, std::vector<std::uint8_t> bytes) {
  arriving_.push(arrival, std::move(bytes));
}

void OperatorSite::step(double wall, const Eigen::Vector3d& p_base_tip,
                        const Eigen::Vector3d& a_base_tip) {
  a_base_tip_ = a_base_tip;
  while (const auto bytes = arriving_.pop(wall)) {
    const std::optional<CorrectionMessage> message = decode(*bytes, epoch_);
    if (message && message->object < objects_.size()) apply(*message);
  }
  const Eigen::Vector3d p_base_bent = p_base_tip - deflection_.p_base();
  predictor_.step(p_base_bent);
  deflection_.step(p_base_tip, tip_force(), step_);
  count_held();
  tips_.push_back({predictor_.now(), p_base_bent});
  while (tips_.front().t < predictor_.now() - history_) tips_.pop_front();
}

Eigen::Vector3d OperatorSite::tip_force() const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const BodyState& state : predictor_.world().state()) sum += state.tool_force_base;
  return sum;
}

void OperatorSite::count_held() {
  for (std::size_t i = 0; i < held_.size(); ++i) {
    const BodyState& state = predictor_.world().state()[i];
    HeldTimes& held = held_[i];
    if (state.is_blocked) {
      if (held.blocked == 0.0) held.first_blocked = predictor_.now();
      held.blocked += step_;
    }
    if (state.is_saturated) {
      if (held.saturated == 0.0) held.first_saturated = predictor_.now();
      held.saturated += step_;
    }
  }
}

bool OperatorSite::apply(const CorrectionMessage& message) {
  Known& object = objects_[message.object];
  if (object.received && !is_newer(message.sequence, *object.received)) return false;
  object.received = message.sequence;
  Correction correction;
  correction.t = message.t;
  correction.body = message.object;
  if (message.pose) correction.T_base_object = pose_at(*message.pose, object.T_base_start);
  correction.twist = message.twist;
  if (!is_empty(message.parameters)) {
    overwrite(object.parameters, message.parameters);
    correction.physics = complete_physics(object.parameters, object.model, object.T_base_start,
                                          gravity_, unknown_objects_)
                             .physics;
    correction.physics->stribeck_speed = object.stribeck_speed;
  }
  const PlanarPose before = planar_pose_of(predictor_.world().T_base_object(message.object));
  const std::optional<BodyState> past = predictor_.state_at(message.object, message.t);
  if (!predictor_.correct(correction)) {
    ++late_;
    apply_from_now(correction);
    return false;
  }
  double stated = 0.0;
  if (message.pose && past) {
    const Pose T_base_past = predictor_.world().pose_of(message.object, *past);
    stated = distance(*message.pose, planar_pose_of(T_base_past), rotation_radius_);
  }
  limit_motion(message, before, stated);
  return true;
}

void OperatorSite::apply_from_now(const Correction& late) {
  if (!late.physics) return;
  Correction known;
  known.t = predictor_.now();
  known.body = late.body;
  known.physics = late.physics;
  predictor_.correct(known);
}

void OperatorSite::place(std::size_t object, const Pose& T_base_object) {
  Correction placed;
  placed.t = predictor_.now();
  placed.body = object;
  placed.T_base_object = pose_at(planar_pose_of(T_base_object), objects_[object].T_base_start);
  placed.twist = Eigen::Vector3d::Zero();
  predictor_.correct(placed);
}

void OperatorSite::limit_motion(const CorrectionMessage& message, const PlanarPose& before,
                                double stated) {
  const Pose T_base_after = predictor_.world().T_base_object(message.object);
  const PlanarPose after = planar_pose_of(T_base_after);
  const double moved = distance(after, before, rotation_radius_);
  const double allowed = stated + tip_path_since(message.t) + kMotionMargin;
  if (moved <= allowed) return;
  const double share = allowed / moved;
  const PlanarPose nearer{before.x + share * (after.x - before.x),
                          before.y + share * (after.y - before.y),
                          before.yaw + share * std::remainder(after.yaw - before.yaw, 2.0 * M_PI)};
  Correction back;
  back.t = predictor_.now();
  back.body = message.object;
  back.T_base_object = pose_at(nearer, objects_[message.object].T_base_start);
  back.twist = Eigen::Vector3d::Zero();
  predictor_.correct(back);
}

double OperatorSite::tip_path_since(double t) const {
  double path = 0.0;
  for (std::size_t i = tips_.size(); i-- > 1 && tips_[i - 1].t >= t;) {
    path += (tips_[i].p_base - tips_[i - 1].p_base).norm();
  }
  return path;
}

Prediction OperatorSite::prediction(std::size_t object) const {
  const BodyState& state = predictor_.world().state()[object];
  const Eigen::Vector3d force = predictor_.shown(object).force_base;
  return {planar_pose_of(predictor_.world().T_base_object(object)), state.tool_force_base,
          force + inertial_force(a_base_tip_, force, objects_[object].contact_mass), state.phase,
          objects_[object].received.value_or(0)};
}

}  // namespace pcavr
