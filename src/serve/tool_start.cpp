// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "serve/tool_start.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "pcavr/base/model/cad_model.hpp"

namespace pcavr {
namespace {

constexpr int kSides = 24;           // directions around a body: 15 degrees apart
constexpr float kMaxReach = 100.0F;  // [m] beyond any scene

/// Surfaces in which a tool must not start.
struct Surroundings {
  SurfaceQuery fixed;
  SurfaceQuery guards;
  std::vector<SurfaceQuery> bodies;
};

Surroundings surroundings_of(const HapticWorldModel& model) {
  const TriangleMesh& scan = model.world.static_mesh_base;
  Surroundings all{SurfaceQuery(scan), SurfaceQuery(model.guard_mesh_base), {}};
  for (const WorldBody& body : model.world.bodies) {
    all.bodies.emplace_back(transformed(body.T_base_object, body.model.mesh_object));
  }
  return all;
}

/// Movable bodies, the nearest to the base's axis first.
std::vector<std::size_t> nearest_first(const HapticWorldModel& model, const Surroundings& all) {
  std::vector<std::pair<float, std::size_t>> found;
  for (std::size_t i = 0; i < all.bodies.size(); ++i) {
    if (!model.world.bodies[i].is_movable) continue;
    found.emplace_back(all.bodies[i].bounds().center().head<2>().norm(), i);
  }
  std::sort(found.begin(), found.end());
  std::vector<std::size_t> order;
  for (const auto& [distance, index] : found) order.push_back(index);
  return order;
}

/// Horizontal unit vectors: to the base's axis, then alternately to its two sides.
std::vector<Eigen::Vector3f> sides_from(const Eigen::Vector3f& middle) {
  const float towards_base = std::atan2(-middle.y(), -middle.x());
  std::vector<Eigen::Vector3f> sides;
  for (int i = 0; i < kSides; ++i) {
    const int step = (i % 2 == 0 ? -1 : 1) * ((i + 1) / 2);
    const float angle =
        towards_base + static_cast<float>(step) * 2.0F * std::numbers::pi_v<float> / kSides;
    sides.emplace_back(std::cos(angle), std::sin(angle), 0.0F);
  }
  return sides;
}

bool is_free(const Surroundings& all, const Eigen::Vector3f& place, float radius) {
  if (all.fixed.closest(place, radius) || all.guards.closest(place, radius)) return false;
  // A guard above would have to be passed to get there.
  if (all.guards.cast(place, Eigen::Vector3f::UnitZ())) return false;
  return std::none_of(all.bodies.begin(), all.bodies.end(),
                      [&](const SurfaceQuery& body) { return body.closest(place, radius); });
}

float hit_distance(const SurfaceQuery& surface, const Eigen::Vector3f& origin,
                   const Eigen::Vector3f& direction) {
  const auto hit = surface.cast(origin, direction);
  return hit ? hit->distance : kMaxReach;
}

/// Whether the body is the first thing that a motion from `place` meets.
bool meets_first(const Surroundings& all, std::size_t body, const Eigen::Vector3f& place,
                 const Eigen::Vector3f& direction) {
  const float distance = hit_distance(all.bodies[body], place, direction);
  if (distance >= kMaxReach || hit_distance(all.fixed, place, direction) < distance) return false;
  for (std::size_t i = 0; i < all.bodies.size(); ++i) {
    if (i != body && hit_distance(all.bodies[i], place, direction) < distance) return false;
  }
  return true;
}

/// A place outside of the body in direction `side`, at its mid-height but above what it stands on.
Eigen::Vector3f place_beside(const SurfaceQuery& body, const Eigen::Vector3f& side, float radius,
                             float clearance) {
  const Eigen::AlignedBox3f& box = body.bounds();
  Eigen::Vector3f middle = box.center();
  middle.z() = std::max(middle.z(), box.min().z() + 1.1F * radius);
  // The ray starts far away, so that the first surface is the outer one.
  const Eigen::Vector3f outside = middle + kMaxReach * side;
  const float reach = kMaxReach - hit_distance(body, outside, -side);
  return middle + (reach + radius + clearance) * side;
}

}  // namespace

std::optional<Eigen::Vector3d> tool_start_beside_body(
    const HapticWorldModel& model, double clearance,
    const std::function<bool(const Eigen::Vector3d&)>& is_guarded) {
  const Surroundings all = surroundings_of(model);
  const auto radius = static_cast<float>(model.world.tool_radius);
  for (const std::size_t body : nearest_first(model, all)) {
    for (const Eigen::Vector3f& side : sides_from(all.bodies[body].bounds().center())) {
      const Eigen::Vector3f place =
          place_beside(all.bodies[body], side, radius, static_cast<float>(clearance));
      if (!is_free(all, place, radius) || !meets_first(all, body, place, -side)) continue;
      if (!is_guarded(place.cast<double>())) return place.cast<double>();
    }
  }
  return std::nullopt;
}

}  // namespace pcavr
