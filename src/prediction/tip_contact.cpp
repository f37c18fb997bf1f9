// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "prediction/tip_contact.hpp"

#include <cmath>

#include <Eigen/Geometry>

#include "prediction/contact_force.hpp"

namespace pcavr::detail {
namespace {

/// Tangential over normal stiffness of a sphere on a flat face: 2 (1 - nu) / (2 - nu), between 0.67
/// and 1 [Mindlin 1949]; this at nu = 1/3.
constexpr double kTangentialShare = 0.8;

Eigen::Vector3d across(const Eigen::Vector3d& normal, const Eigen::Vector3d& vector) noexcept {
  return vector - normal.dot(vector) * normal;
}

}  // namespace

std::optional<Touch> touch_of(const UprightBody& body, const PlanarState& planar,
                              const Eigen::Vector3d& p_base_tip, double radius) noexcept {
  const Eigen::Rotation2Dd turn(planar.yaw);
  Eigen::Vector3d p = p_base_tip;
  p.head<2>() = turn.inverse() * (p_base_tip.head<2>() - planar.position);
  const auto closest = body.surface().closest(p, radius + kClearance);
  if (!closest) return std::nullopt;
  Touch touch;
  touch.depth = radius - closest->distance;
  touch.normal = closest->normal;
  touch.normal.head<2>() = turn * closest->normal.head<2>();
  touch.arm = turn * closest->point.head<2>();
  touch.height = closest->point.z();
  return touch;
}

TipForce tip_force(const BodyPhysics& physics, const Eigen::Vector3d& normal, double depth,
                   double rate, const Eigen::Vector3d& stretch,
                   const Eigen::Vector3d& stretch_rate) noexcept {
  TipForce result;
  const ContactForce press = contact_force(physics.contact, depth, rate);
  if (!(press.force > 0.0)) return result;
  result.normal_stiffness = press.stiffness;
  result.normal_damping = press.damping;
  const double stiffness =
      kTangentialShare * physics.contact.stiffness * power(depth, physics.contact.exponent) / depth;
  const double damping = kTangentialShare * press.damping;
  Eigen::Vector3d drag = across(normal, stiffness * stretch + damping * stretch_rate);
  const double most = physics.tool_friction * press.force;
  const double size = drag.norm();
  if (size > most) {
    drag *= most / size;
    result.stretch = drag / stiffness;
  } else {
    result.stretch = across(normal, stretch);
    result.tangential_stiffness = stiffness;
    result.tangential_damping = damping;
  }
  result.force = drag - press.force * normal;
  return result;
}

}  // namespace pcavr::detail
