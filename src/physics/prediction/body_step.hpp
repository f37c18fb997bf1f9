// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "physics/prediction/side_contact.hpp"
#include "physics/prediction/tip_contact.hpp"

namespace pcavr::detail {

/// Number of substeps that resolve the oscillation of the body on the tip's contact: 1 for all but
/// the stiffest contacts of light bodies.
[[nodiscard]] int count_substeps(const UprightBody& body, const BodyState& state,
                                 const TipPath& tip, double dt) noexcept;

struct BodyStep {
  BodyState state;
  /// [m] between the body's motion and the one that its contacts' forces cause: large where the
  /// solver did not converge.
  double residual = 0.0;
};

/// Moves one body by dt [s] under the tip's contact, its neighbours' and the support's friction.
/// `guess` of the end only saves time (a warm start). Where `relative_tolerance` is not zero,
/// iteration stops once the residual is below this share of the guess's error.
[[nodiscard]] BodyStep step_body(const UprightBody& body, const BodyState& state,
                                 const TipPath& tip, std::span<const SideContact> sides, double dt,
                                 const PlanarState* guess = nullptr,
                                 double relative_tolerance = 0.0) noexcept;

/// The body at rest where it is, and the tip's force on it at the step's end: for one whose motion
/// was ended by what the contacts' forces do not show.
[[nodiscard]] BodyState stop_body(const UprightBody& body, const BodyState& state,
                                  const TipPath& tip, double dt) noexcept;

}  // namespace pcavr::detail
