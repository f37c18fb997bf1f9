// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/prediction/side_contact.hpp"

#include <algorithm>
#include <cmath>

namespace pcavr::detail {
namespace {

/// [m/s] Below, friction grows with the speed (regularised Coulomb friction): twice the speed from
/// which a body counts as sliding.
constexpr double kMinSlip = 0.002;
/// [m] The damping increases from 0 over this depth: with a discontinuous force, a step in which
/// two bodies touch first may have no solution.
constexpr double kDampingRamp = 1e-5;

}  // namespace

SideForce side_force(const SideContact& contact, const Eigen::Vector2d& slip,
                     double time) noexcept {
  SideForce result;
  const double closing = contact.normal.dot(slip);
  const double depth = contact.depth + closing;
  if (!(depth > 0.0)) return result;
  // Damper and spring balance at the maximum separation speed.
  const double min_damping = contact.stiffness * depth / contact.max_separation_speed;
  const double damping =
      std::max(contact.damping * std::min(depth / kDampingRamp, 1.0), min_damping);
  // The speed at the step's end (the displacement gives the mean): so a contact that stops the body
  // in one step does not make it rebound.
  const double rate = 2.0 * closing / time - contact.closing;
  const double force = contact.stiffness * depth + damping * rate;
  if (!(force > 0.0)) return result;
  const double damping_slope = damping != contact.damping ? damping / depth * rate : 0.0;
  const double normal_stiffness = contact.stiffness + damping_slope + 2.0 * damping / time;
  const Eigen::Vector2d along(-contact.normal.y(), contact.normal.x());
  const double speed = along.dot(slip) / time;
  const double drag = contact.friction * force / (std::abs(speed) + kMinSlip);
  result.force = force * contact.normal + drag * speed * along;
  result.stiffness = normal_stiffness * contact.normal * contact.normal.transpose() +
                     drag / time * along * along.transpose();
  return result;
}

}  // namespace pcavr::detail
