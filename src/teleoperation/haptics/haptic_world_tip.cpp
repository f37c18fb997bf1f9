// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>

#include "teleoperation/haptics/friction_cone.hpp"
#include "teleoperation/haptics/haptic_world_content.hpp"

namespace pcavr {
namespace {

/// Cosine between the normals nearest to the tip and at the proxy's contact: on the same face.
constexpr double kMinSameFaceCosine = 0.7;
/// Backtracking of a tip that has penetrated too far: to 0.43 of its depth.
constexpr double kBacktrackFactor = 0.9;
constexpr int kMaxBacktracks = 8;
/// Share of the maximum penetration at which the force on a body no longer grows.
constexpr double kSaturatedShare = 0.99;

}  // namespace

/// Whether the tool would be collision-free at the HIP and on the straight path to it.
bool HapticWorld::Content::may_catch_up() const noexcept {
  if (is_resting_on_body() || proxy.centre() == hip || proxy.is_separated_from(hip)) return false;
  return std::none_of(bodies.begin(), bodies.end(),
                      [&](const Body& body) { return closest(body, hip).has_value(); });
}

/// Moves the proxy after the HIP, which moved by `displacement` [m].
void HapticWorld::Content::follow(double displacement, double dt) noexcept {
  goal = detail::friction_limited_goal(hip, proxy.centre(), scan_normal, options.scan_friction);
  const double budget =
      displacement + body_displacement + (may_catch_up() ? options.catch_up_speed * dt : 0.0);
  if (!(budget > 0.0)) return;
  proxy.follow(goal, budget, budget);
  scan_normal = proxy.static_normal(hip);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    Body& body = bodies[i];
    body.is_under_tool = is_near(body, proxy.centre()) && proxy.rests_on(kFirstBody + i, goal);
  }
}

bool HapticWorld::Content::is_resting_on_body() const noexcept {
  return std::any_of(bodies.begin(), bodies.end(),
                     [](const Body& body) { return body.is_under_tool; });
}

/// The prediction's tip: at the proxy's centre, plus a penetration into the body that it touches.
void HapticWorld::Content::update_tip(double dt) noexcept {
  tip_before = tip;
  tip = proxy.centre();
  for (Body& body : bodies) body.is_saturated = false;
  static_proxy = proxy.centre();
  if (!is_resting_on_body()) {
    penetration.setZero();
  } else {
    double max_penetration = std::numeric_limits<double>::infinity();
    for (const Body& body : bodies) {
      if (body.is_under_tool) max_penetration = std::min(max_penetration, body.max_penetration);
    }
    double budget = max_penetration;
    static_proxy = proxy.centre_ignoring_moving(goal, budget);
    const Eigen::Vector3d direction = static_proxy - proxy.centre();
    const double length = direction.norm();
    penetration = limited_penetration(direction, std::min(length, max_penetration),
                                      options.max_penetration_speed * dt);
    // A faster tip counts as placed anew in the prediction, which would move the body away.
    const bool has_jumped =
        !tip_before || (proxy.centre() + penetration - *tip_before).norm() > max_tip_speed * dt;
    if (has_jumped) penetration.setZero();
    *tip += penetration;
    // The HIP's depth beyond the body's maximum penetration makes no force from the scan.
    const double excess = length > 0.0 ? (hip - static_proxy).dot(direction) / length : 0.0;
    if (budget <= 0.0 && excess > 0.0) static_proxy += excess / length * direction;
    const bool is_deepest = penetration.norm() >= kSaturatedShare * max_penetration;
    for (Body& body : bodies) {
      body.is_saturated =
          body.is_under_tool && is_deepest && (hip - proxy.centre()).norm() > max_penetration;
    }
  }
  if (!tip_before) tip_before = tip;
}

/// The penetration for a desired one of `desired` [m] along `direction`: changes by at most
/// `max_change` [m] in this cycle, so that the tip does not jump where the direction does.
/// Backtracks until the face that the tip came through is still the nearest: near an edge that is
/// less than in the middle of a face. It does not oscillate there, because it may stay as deep
/// as it was.
Eigen::Vector3d HapticWorld::Content::limited_penetration(const Eigen::Vector3d& direction,
                                                          double desired,
                                                          double max_change) const noexcept {
  const double before = penetration.norm();
  const Eigen::Vector3d start_at =
      before > desired ? Eigen::Vector3d(desired / before * penetration) : penetration;
  const Eigen::Vector3d change = desired * direction.stableNormalized() - start_at;
  const double change_norm = change.norm();
  const Eigen::Vector3d next =
      start_at + (change_norm > max_change ? max_change / change_norm : 1.0) * change;
  double depth = next.norm();
  if (depth <= proxy.radius()) return next;
  const Eigen::Vector3d unit = next / depth;
  for (int i = 0; i < kMaxBacktracks && depth > proxy.radius(); ++i) {
    if (is_through_contact_face(proxy.centre() + depth * unit)) return depth * unit;
    depth = depth > before ? before : kBacktrackFactor * depth;
  }
  return std::min(depth, proxy.radius()) * unit;
}

bool HapticWorld::Content::is_through_contact_face(const Eigen::Vector3d& p) const noexcept {
  return std::all_of(bodies.begin(), bodies.end(), [&](const Body& body) {
    if (!body.is_under_tool) return true;
    const auto at_tip = closest(body, p);
    const auto at_proxy = closest(body, proxy.centre(), 2.0 * proxy.radius());
    return !at_tip || !at_proxy || at_tip->normal.dot(at_proxy->normal) > kMinSameFaceCosine;
  });
}

void HapticWorld::Content::release() noexcept {
  hip = proxy.centre();
  goal = hip;
  static_proxy = hip;
  scan_normal.setZero();
  acceleration.reset();
  tip.reset();
  tip_before.reset();
  penetration.setZero();
  body_displacement = 0.0;
  for (Body& body : bodies) {
    body.is_under_tool = false;
    body.is_saturated = false;
  }
}

}  // namespace pcavr
