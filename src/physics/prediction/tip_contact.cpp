// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/prediction/tip_contact.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "pcavr/physics/contact/hunt_crossley.hpp"

namespace pcavr::detail {
namespace {

/// Tangential over normal stiffness of a sphere on a flat face: 2 (1 - nu) / (2 - nu), between 0.67
/// and 1 [Mindlin 1949]; this at nu = 1/3.
constexpr double kTangentialShare = 0.8;
/// Shortest distance from the tip's centre to the touched point for deep tips, as a share of its
/// radius.
constexpr double kMinDistance = 0.25;

Eigen::Vector3d tangential_part(const Eigen::Vector3d& normal,
                                const Eigen::Vector3d& vector) noexcept {
  return vector - normal.dot(vector) * normal;
}

/// `turn` is the body's rotation: sine and cosine cost as much as the rest of a distant body's
/// step.
Eigen::Vector3d in_body(const PlanarState& planar, const Eigen::Matrix2d& turn,
                        const Eigen::Vector3d& p_base) noexcept {
  Eigen::Vector3d p = p_base;
  p.head<2>() = turn.transpose() * (p_base.head<2>() - planar.position);
  return p;
}

TipContact contact_at(const UprightBody& body, const Eigen::Matrix2d& turn,
                      const ClosestSurface::Result& closest, double radius) noexcept {
  TipContact contact;
  contact.depth = radius - closest.distance + closest.normal.dot(body.physics().surface_offset);
  contact.normal = closest.normal;
  contact.normal.head<2>() = turn * closest.normal.head<2>();
  contact.arm = turn * closest.point.head<2>();
  contact.height = closest.point.z();
  return contact;
}

}  // namespace

std::optional<TipContact> find_tip_contact(const UprightBody& body, const PlanarState& planar,
                                           const Eigen::Vector3d& p_base_tip, double radius,
                                           const Eigen::Vector3d& entry_normal) noexcept {
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(planar.yaw).toRotationMatrix();
  const auto closest = body.surface().closest(in_body(planar, turn, p_base_tip),
                                              radius + kMaxClearance, entry_normal);
  if (!closest) return std::nullopt;
  return contact_at(body, turn, *closest, radius);
}

TipContacts find_tip_contacts(const UprightBody& body, const PlanarState& planar,
                              const Eigen::Vector3d& p_base_tip, double radius,
                              const Eigen::Vector3d& entry_normal) noexcept {
  TipContacts contacts;
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(planar.yaw).toRotationMatrix();
  const Eigen::Vector3d p = in_body(planar, turn, p_base_tip);
  const auto closest = body.surface().closest(p, radius + kMaxClearance, entry_normal);
  if (!closest) return contacts;
  contacts.all[0] = contact_at(body, turn, *closest, radius);
  // The offset of a face may make it touched before the tip's sphere reaches it, and deeper than a
  // closer face.
  const double reach = radius + body.physics().surface_offset.norm();
  if (!(closest->distance < reach)) return contacts;
  std::array<ClosestSurface::Result, BodyState::kMaxGrips> minima;
  const std::size_t found = body.surface().local_minima(p, reach, *closest, minima);
  for (std::size_t i = 1; i < found; ++i) {
    TipContact contact = contact_at(body, turn, minima[i], radius);
    if (!(contact.depth > 0.0)) continue;
    if (contact.depth > contacts.deepest().depth) std::swap(contact, contacts.all[0]);
    if (contact.depth > 0.0) contacts.all[static_cast<std::size_t>(contacts.count++)] = contact;
  }
  return contacts;
}

TipForce tip_force(const UprightBody& body, double radius, const Eigen::Vector3d& normal,
                   double depth, double rate, const Eigen::Vector3d& deflection,
                   const Eigen::Vector3d& deflection_rate) noexcept {
  TipForce result;
  const BodyPhysics& physics = body.physics();
  const ContactForce press = contact_force(physics.contact, depth, rate, body.max_contact_force());
  if (!(press.force > 0.0)) return result;
  result.normal_stiffness = press.stiffness;
  result.normal_damping = press.damping;
  // At a vertex the normal of the undeformed shapes turns with the tip's lateral displacement, as
  // if a spring pushed it off: deformed surfaces conform, so that the contact's own stiffness
  // remains.
  const double elastic = elastic_force(physics.contact, depth);
  const double stiffness = kTangentialShare * physics.contact.exponent * elastic / depth +
                           elastic / std::max(radius - depth, kMinDistance * radius);
  const double damping = kTangentialShare * press.damping;
  Eigen::Vector3d tangential =
      tangential_part(normal, stiffness * deflection + damping * deflection_rate);
  const double max_tangential = physics.tool_friction * press.force;
  const double size = tangential.norm();
  if (size > max_tangential) {
    tangential *= max_tangential / size;
    result.deflection = tangential / stiffness;
  } else {
    result.deflection = tangential_part(normal, deflection);
    result.tangential_stiffness = stiffness;
    result.tangential_damping = damping;
  }
  result.force = tangential - press.force * normal;
  return result;
}

}  // namespace pcavr::detail
