// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/tip_contact.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/core/gravity.hpp"

namespace pcavr::simulation {
namespace {

/// Presliding displacement between tip and body: the shear of a rubber tip [m].
constexpr double kTipShearDisplacement = 5e-5;

struct ClosestPoint {
  Eigen::Vector3d point;   ///< on the cuboid
  Eigen::Vector3d normal;  ///< unit, from the cuboid towards the sphere's centre
  double distance;         ///< signed distance of the sphere's centre, negative inside [m]
};

ClosestPoint closest_point_on(const Eigen::AlignedBox3d& box, const Eigen::Vector3d& p,
                              const std::optional<Eigen::Vector3d>& entry_normal) {
  if (!box.contains(p)) {
    const Eigen::Vector3d point = p.cwiseMax(box.min()).cwiseMin(box.max());
    const double distance = (p - point).norm();
    return {point, (p - point) / std::max(distance, 1e-12), distance};
  }
  // A tip inside goes out through the face by which it came in, at first the closest one.
  ClosestPoint best{p, Eigen::Vector3d::UnitZ(), -1e9};
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool is_upper : {false, true}) {
      const Eigen::Vector3d normal = Eigen::Vector3d::Unit(axis) * (is_upper ? 1.0 : -1.0);
      if (entry_normal && *entry_normal != normal) continue;
      const double out = is_upper ? p[axis] - box.max()[axis] : box.min()[axis] - p[axis];
      if (out <= best.distance) continue;
      best = {p, normal, out};
      best.point[axis] = is_upper ? box.max()[axis] : box.min()[axis];
    }
  }
  return best;
}

/// The closest point on a convex outline, counter-clockwise; its distance is negative inside.
struct ClosestOnOutline {
  Eigen::Vector2d point;
  Eigen::Vector2d normal;
  double distance;
};

ClosestOnOutline closest_point_on(const std::vector<Eigen::Vector2d>& outline,
                                  const Eigen::Vector2d& p) {
  ClosestOnOutline outside{p, Eigen::Vector2d::UnitY(), 1e9};
  ClosestOnOutline inside{p, Eigen::Vector2d::UnitY(), -1e9};
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d& a = outline[i];
    const Eigen::Vector2d edge = outline[(i + 1) % outline.size()] - a;
    const Eigen::Vector2d outward = Eigen::Vector2d(edge.y(), -edge.x()).normalized();
    const double depth = outward.dot(p - a);
    if (depth > inside.distance) inside = {p - depth * outward, outward, depth};
    const double share = std::clamp((p - a).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
    const Eigen::Vector2d point = a + share * edge;
    const double distance = (p - point).norm();
    if (distance < outside.distance) {
      outside = {point, (p - point) / std::max(distance, 1e-12), distance};
    }
  }
  return inside.distance > 0.0 ? outside : inside;
}

ClosestPoint closest_point_on(const std::vector<Eigen::Vector2d>& outline_xz, double begin_y,
                              double end_y, const Eigen::Vector3d& p) {
  const ClosestOnOutline flat = closest_point_on(outline_xz, Eigen::Vector2d(p.x(), p.z()));
  const Eigen::Vector3d normal(flat.normal.x(), 0.0, flat.normal.y());
  const double beyond = std::max(begin_y - p.y(), p.y() - end_y);  // of the ends
  const double side = p.y() > 0.5 * (begin_y + end_y) ? 1.0 : -1.0;
  if (flat.distance <= 0.0 && (beyond > 0.0 || beyond > flat.distance)) {
    const Eigen::Vector3d point(p.x(), side > 0.0 ? end_y : begin_y, p.z());
    return {point, side * Eigen::Vector3d::UnitY(), beyond};
  }
  const Eigen::Vector3d point(flat.point.x(), std::clamp(p.y(), begin_y, end_y), flat.point.y());
  if (beyond <= 0.0) return {point, normal, flat.distance};
  const double distance = (p - point).norm();
  return {point, (p - point) / std::max(distance, 1e-12), distance};
}

}  // namespace

TipContact::TipContact(const PlantBody& body, double tip_radius)
    : parameters_(body.parameters), radius_(tip_radius), bottom_body_(1e9), bounding_radius_(0.0) {
  const double coefficient = body.parameters.tool_friction_coefficient;
  law_ = {.static_coefficient = coefficient,
          .sliding_coefficient = coefficient,
          .breakaway_deflection = kTipShearDisplacement};
  if (coefficient > 0.0) law_.damping = bristle_damping(law_.stiffness(), kStandardGravity);
  for (const PlantCuboid& part : body.parts) {
    const Eigen::Vector3d low = part.centre - part.half_extents;
    const Eigen::Vector3d high = part.centre + part.half_extents;
    parts_.push_back({.box_body = Eigen::AlignedBox3d(low, high)});
    bottom_body_ = std::min(bottom_body_, low.z());
    bounding_radius_ = std::max(bounding_radius_, low.cwiseAbs().cwiseMax(high.cwiseAbs()).norm());
  }
  for (const PlantPrism& prism : body.prisms) {
    parts_.push_back({.box_body = Eigen::AlignedBox3d(Eigen::Vector3d(0.0, prism.begin_y, 0.0),
                                                      Eigen::Vector3d(0.0, prism.end_y, 0.0)),
                      .outline_xz = prism.outline_xz});
  }
}

TipLoad TipContact::advance(const Tip& tip, const BodyMotion& body, double dt) {
  TipLoad load;
  if ((tip.p_base - body.p_base).norm() > bounding_radius_ + radius_) {
    for (Part& part : parts_) {
      part.deflection.setZero();
      part.entry_normal.reset();
    }
    return load;
  }
  for (Part& part : parts_) add(part, tip, body, dt, load);
  return load;
}

void TipContact::add(Part& part, const Tip& tip, const BodyMotion& body, double dt,
                     TipLoad& load) const {
  const Eigen::Vector3d p_body = body.R_base_body.transpose() * (tip.p_base - body.p_base);
  const ClosestPoint closest = part.outline_xz.empty()
                                   ? closest_point_on(part.box_body, p_body, part.entry_normal)
                                   : closest_point_on(part.outline_xz, part.box_body.min().y(),
                                                      part.box_body.max().y(), p_body);
  part.entry_normal.reset();
  if (part.outline_xz.empty() && closest.distance < 0.0) part.entry_normal = closest.normal;
  const double penetration = radius_ - closest.distance;
  if (penetration <= 0.0) {
    part.deflection.setZero();
    return;
  }
  const Eigen::Vector3d normal = body.R_base_body * closest.normal;
  const Eigen::Vector3d point = body.p_base + body.R_base_body * closest.point;
  const Eigen::Vector3d r = point - body.centre_base;
  const Eigen::Vector3d v_body(body.twist.x() - body.twist.z() * r.y(),
                               body.twist.y() + body.twist.z() * r.x(), 0.0);
  const Eigen::Vector3d velocity = tip.v_base - v_body;
  const double approach_speed = -velocity.dot(normal);
  const double power = std::pow(penetration, parameters_.contact_exponent);
  const double normal_force = std::max(
      0.0, power * (parameters_.contact_stiffness + parameters_.contact_damping * approach_speed));
  Eigen::Vector3d force = -normal_force * normal;
  if (parameters_.tool_friction_coefficient > 0.0) {
    part.deflection -= part.deflection.dot(normal) * normal;
    const Eigen::Vector3d tangential_velocity = velocity + approach_speed * normal;
    force += normal_force * advance_bristles<3>(law_, tangential_velocity, dt, part.deflection);
  }
  load.is_touched = true;
  load.force += force;
  load.tip_torque += (point - tip.p_base).cross(force);
  load.moment += r.x() * force.y() - r.y() * force.x();
  const double height = closest.point.z() - bottom_body_;
  load.tipping_moment += height * force.head<2>() - force.z() * r.head<2>();
}

}  // namespace pcavr::simulation
