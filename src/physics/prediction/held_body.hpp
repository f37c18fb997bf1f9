// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "pcavr/physics/prediction/predicted_world.hpp"

namespace pcavr::detail {

[[nodiscard]] inline bool is_finite(const BodyState& state) noexcept {
  const PlanarState& planar = state.planar;
  return planar.position.allFinite() && std::isfinite(planar.yaw) && planar.twist.allFinite() &&
         state.tool_force_base.allFinite() && state.tangential_deflection_base.allFinite() &&
         !std::isnan(state.penetration);  // infinite: nothing is near
}

/// The state at rest and without contact, where a step's forces overflow: each parameter is in its
/// range, but together they may be no body's.
[[nodiscard]] inline BodyState held(BodyState state) noexcept {
  state.planar.twist.setZero();
  state.planar.phase = FrictionPhase::static_contact;
  state.tangential_deflection_base.setZero();
  state.tool_force_base.setZero();
  state.grip_count = 0;
  state.entry_normal.setZero();
  state.penetration = 0.0;
  state.phase = MotionPhase::free;
  return state;
}

}  // namespace pcavr::detail
