// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "prediction/side_contact.hpp"

#include <algorithm>
#include <cmath>

namespace pcavr::detail {
namespace {

constexpr double kFriction = 0.3;         // between bodies; nothing measures it
constexpr double kMinSlip = 0.002;        // [m/s] below, friction grows with the speed
constexpr double kFastestParting = 0.05;  // [m/s] at which an overlap is undone
/// [m] The damper takes hold over this depth: a force that set in at once would leave a step in
/// which two bodies meet without a solution.
constexpr double kFadesIn = 1e-5;

}  // namespace

SideForce side_force(const SideContact& contact, const Eigen::Vector2d& slip,
                     double time) noexcept {
  SideForce result;
  const double closing = contact.normal.dot(slip);
  const double depth = contact.depth + closing;
  if (!(depth > 0.0)) return result;
  // Where the spring pushes the bodies apart at the fastest rate, damper and spring balance.
  const double parting = contact.stiffness * depth / kFastestParting;
  const double damping = std::max(contact.damping * std::min(depth / kFadesIn, 1.0), parting);
  // The speed at the step's end, of which the way tells the mean: so a contact that stops the body
  // in one step does not throw it back.
  const double rate = 2.0 * closing / time - contact.closing;
  const double force = contact.stiffness * depth + damping * rate;
  if (!(force > 0.0)) return result;
  const double rising = damping != contact.damping ? damping / depth * rate : 0.0;
  const double pressing = contact.stiffness + rising + 2.0 * damping / time;
  const Eigen::Vector2d along(-contact.normal.y(), contact.normal.x());
  const double speed = along.dot(slip) / time;
  const double drag = kFriction * force / (std::abs(speed) + kMinSlip);
  result.force = force * contact.normal + drag * speed * along;
  result.stiffness = pressing * contact.normal * contact.normal.transpose() +
                     drag / time * along * along.transpose();
  return result;
}

}  // namespace pcavr::detail
