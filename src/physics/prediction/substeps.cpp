// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Into how many parts a step is divided.
#include <algorithm>
#include <cmath>

#include "physics/prediction/body_step.hpp"

namespace pcavr::detail {
namespace {

/// Maximum phase of the contact's oscillation [rad] in one substep; the maximum number of substeps;
/// and a clearance [m] within which a rotating body may contact.
constexpr double kMaxPhasePerSubstep = 0.5;
constexpr double kMaxSubsteps = 16.0;
constexpr double kNear = 1e-3;

}  // namespace

int count_substeps(const UprightBody& body, const BodyState& state, const TipPath& tip,
                   double dt) noexcept {
  if (!body.is_movable()) return 1;
  const double frequency =
      std::sqrt(body.working_stiffness() / body.physics().friction.mass);  // [rad/s]
  const double substeps = std::ceil(frequency * dt / kMaxPhasePerSubstep);
  if (!(substeps > 1.0)) return 1;
  const double travel =
      (tip.to - tip.from).norm() + dt * state.planar.twist.head<2>().norm() + kNear;
  if (state.penetration < -travel) return 1;
  return static_cast<int>(std::min(substeps, kMaxSubsteps));
}

}  // namespace pcavr::detail
