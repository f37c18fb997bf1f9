// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "teleoperation/haptics/haptic_world_content.hpp"

namespace pcavr {
namespace {

/// Iterations that move the proxy out of overlapping bodies: bounds a cycle's time where they
/// squeeze it.
constexpr int kMaxOverlapIterations = 12;

}  // namespace

bool HapticWorld::Content::is_near(const Body& body, const Eigen::Vector3d& p) const noexcept {
  if (body.fall) return false;
  const double reach = body.shape.bounding_radius + 2.0 * proxy.radius();
  return (body.T_base_object * body.shape.bounding_centre - p).squaredNorm() < reach * reach;
}

/// The closest point of the body's surface to `p`, in base, where it is nearer than `reach` or `p`
/// is inside.
std::optional<detail::ClosestSurface::Result> HapticWorld::Content::closest(
    const Body& body, const Eigen::Vector3d& p, double reach) const noexcept {
  if (!is_near(body, p)) return std::nullopt;
  const Pose& T = body.T_base_object;
  const Eigen::Vector3d p_object = T.rotation().conjugate() * (p - T.translation());
  auto answer = body.shape.surface.closest(p_object, reach);
  if (answer) {
    answer->point = T * answer->point;
    answer->normal = T.rotation() * answer->normal;
  }
  return answer;
}

bool HapticWorld::Content::is_collision_free(const Eigen::Vector3d& centre) const noexcept {
  return proxy.is_collision_free(centre) &&
         std::none_of(bodies.begin(), bodies.end(),
                      [&](const Body& body) { return closest(body, centre).has_value(); });
}

void HapticWorld::Content::start_falling(std::size_t i) noexcept {
  Body& body = bodies[i];
  const Eigen::Vector3d centre = body.T_base_object * body.shape.centre_of_mass;
  const auto edge = supports.nearest_edge(centre.head<2>(), body.shape.bottom);
  if (!edge) return;
  const BodyState& latest = world->state()[i];
  body.fall.emplace(detail::FallingBody::Start{
      body.T_base_object, body.shape.centre_of_mass, latest.planar.twist.head<2>(),
      body.shape.gyration_radius, *edge, options.max_tilt, options.max_fall_height,
      body.shape.surface.bounds()});
  body.is_under_tool = false;
  proxy.remove(kFirstBody + i);
  std::copy(world->state().begin(), world->state().end(), work.begin());
  work[i] = BodyState{};
  work[i].is_present = false;
  world->set_state(work);
}

void HapticWorld::Content::move_bodies(double dt) noexcept {
  if (tip) {
    world->step(*tip_before, *tip, dt);
  } else {
    world->rest(proxy.centre(), dt);
  }
  body_displacement = 0.0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    Body& body = bodies[i];
    if (body.fall) {
      body.fall->step(gravity, dt, floor);
      body.T_base_object = body.fall->T_base_object();
      continue;
    }
    const Pose T_before = body.T_base_object;
    body.T_base_object = world->T_base_object(i);
    proxy.set_pose(kFirstBody + i, body.T_base_object);
    const Eigen::Vector2d centre = world->state()[i].planar.position;
    if (body.has_support && !supports.is_supported(centre, body.shape.bottom)) start_falling(i);
    if (body.is_under_tool) {
      const Eigen::Vector3d moved_centre =
          body.T_base_object * (T_before.inverse() * proxy.centre());
      body_displacement = std::max(body_displacement, (moved_centre - proxy.centre()).norm());
    }
  }
}

/// Moves the proxy out of bodies that overlap it.
void HapticWorld::Content::resolve_overlap() noexcept {
  for (int round = 0; round < kMaxOverlapIterations; ++round) {
    bool is_clear = true;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const auto answer = closest(bodies[i], proxy.centre());
      if (!answer) continue;
      const double overlap = proxy.radius() - answer->distance;
      if (overlap <= detail::kContactSlack) continue;
      const Eigen::Vector3d before = proxy.centre();
      proxy.resolve_overlap(before + (overlap + detail::kContactSlack) * answer->normal,
                            kFirstBody + i);
      body_displacement = std::max(body_displacement, (proxy.centre() - before).norm());
      is_clear = false;
    }
    if (is_clear) return;
  }
}

void HapticWorld::Content::publish_bodies() noexcept {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const BodyState& latest = world->state()[i];
    HapticBodyState& published = state.bodies[i];
    published.T_base_object = bodies[i].fall ? bodies[i].T_base_object : world->shown(i);
    published.tool_force_base = latest.tool_force_base;
    published.phase = latest.phase;
    published.is_outside_model = bodies[i].fall.has_value();
    published.is_blocked = latest.is_blocked && state.is_engaged;
    published.is_saturated = bodies[i].is_saturated || latest.is_saturated;
  }
}

}  // namespace pcavr
