// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/haptics/haptic_world_content.hpp"

namespace pcavr {
namespace {

/// [m] A tip farther from the origin along any axis is invalid.
constexpr double kMaxTipCoordinate = 1e3;
/// Smallest motion of a body that a reset must undo to be undone itself [m], [rad].
constexpr double kMinUndoneTranslation = 1e-4;
constexpr double kMinUndoneRotation = 1e-3;

}  // namespace

bool HapticWorld::Content::is_valid_tip(const Eigen::Vector3d& p) noexcept {
  return (p.array().abs() <= kMaxTipCoordinate).all();
}

void HapticWorld::Content::reset(const Eigen::Vector3d& wanted_tip) noexcept {
  // A second reset in a row must not lose what the first one undid.
  const bool is_repeated = state.can_undo_reset;
  if (!is_repeated) {
    before_reset = world->state();
    for (Body& body : bodies) body.fall_before_reset = body.fall;
  }
  set_bodies(start);
  state.can_undo_reset = is_repeated || have_moved();
  place_tip(wanted_tip);
}

/// Whether the latest reset has moved any body; state.bodies are as before it.
bool HapticWorld::Content::have_moved() const noexcept {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Pose& before = state.bodies[i].T_base_object;
    const Pose& now = bodies[i].T_base_object;
    if (translation_distance(before, now) > kMinUndoneTranslation) return true;
    if (rotation_distance(before, now) > kMinUndoneRotation) return true;
  }
  return false;
}

void HapticWorld::Content::undo_reset(const Eigen::Vector3d& wanted_tip) noexcept {
  if (!state.can_undo_reset) return;
  for (BodyState& body : before_reset) {
    body.planar.twist.setZero();
    body.planar.phase = FrictionPhase::static_contact;
    body.penetration = 0.0;
    body.phase = MotionPhase::free;
    body.is_blocked = false;
    body.is_saturated = false;
    body.tangential_deflection_base.setZero();
    body.grip_count = 0;
    body.tool_force_base.setZero();
  }
  set_bodies(before_reset);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    bodies[i].fall = bodies[i].fall_before_reset;
    if (!bodies[i].fall) continue;
    bodies[i].T_base_object = bodies[i].fall->T_base_object();
    proxy.remove(kFirstBody + i);
  }
  place_tip(wanted_tip);
  state.can_undo_reset = false;
}

void HapticWorld::Content::set_bodies(const std::vector<BodyState>& bodies_at) noexcept {
  world->set_state(bodies_at);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    bodies[i].fall.reset();
    bodies[i].is_under_tool = false;
    bodies[i].T_base_object = world->T_base_object(i);
    proxy.set_pose(kFirstBody + i, bodies[i].T_base_object);
  }
}

void HapticWorld::Content::place_tip(const Eigen::Vector3d& wanted_tip) noexcept {
  is_placed = is_valid_tip(wanted_tip);
  Eigen::Vector3d centre = is_placed ? wanted_tip : Eigen::Vector3d(0.0, 0.0, top);
  while (centre.z() < top && !is_collision_free(centre)) centre.z() += 0.5 * proxy.radius();
  proxy.set_centre(centre);
  hip = centre;
  release();
  state.force_base.setZero();
  state.is_engaged = false;
  state.touches_scan = false;
  state.touched_body.reset();
  state.p_base_hip = hip;
  state.p_base_proxy = centre;
  publish_bodies();
}

}  // namespace pcavr
