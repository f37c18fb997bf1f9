// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "prediction/side_contact.hpp"

#include <algorithm>
#include <cmath>

namespace pcavr::detail {
namespace {

constexpr double kFriction = 0.3;         // between bodies; nothing measures it
constexpr double kLeastSlip = 0.002;      // [m/s] below, friction grows with the speed
constexpr double kFastestParting = 0.05;  // [m/s] at which an overlap is undone

}  // namespace

SideForce side_force(const SideContact& contact, const Eigen::Vector2d& slip,
                     double time) noexcept {
  SideForce result;
  const double closing = contact.normal.dot(slip);
  const double depth = contact.depth + closing;
  if (!(depth > 0.0)) return result;
  // Where the spring pushes the bodies apart at the fastest rate, damper and spring balance.
  const double damping = std::max(contact.damping, contact.stiffness * depth / kFastestParting);
  const double force = contact.stiffness * depth + damping * closing / time;
  if (!(force > 0.0)) return result;
  const Eigen::Vector2d along(-contact.normal.y(), contact.normal.x());
  const double speed = along.dot(slip) / time;
  const double drag = kFriction * force / (std::abs(speed) + kLeastSlip);
  result.force = force * contact.normal + drag * speed * along;
  result.stiffness =
      (contact.stiffness + damping / time) * contact.normal * contact.normal.transpose() +
      drag / time * along * along.transpose();
  return result;
}

}  // namespace pcavr::detail
