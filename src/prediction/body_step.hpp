// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "prediction/side_contact.hpp"
#include "prediction/tip_contact.hpp"

namespace pcavr::detail {

/// Into how many parts a step has to be cut so that the tip's contact is followed through its
/// swing: 1 for all but the stiffest contacts of light bodies.
[[nodiscard]] int parts_of_step(const UprightBody& body, const BodyState& state, const TipPath& tip,
                                double dt) noexcept;

struct BodyStep {
  BodyState state;
  /// [m] by which the body's motion is off what its contacts' forces lead to: large where no end of
  /// the step suits both.
  double gap = 0.0;
};

/// Moves one body by dt [s] under the tip's contact, its neighbours' and the support's friction.
/// `guess`, the end as one believes it, only saves time. Where `enough_share` is not zero, an end
/// that is so much nearer to the solution than the guess will do.
[[nodiscard]] BodyStep step_body(const UprightBody& body, const BodyState& state,
                                 const TipPath& tip, std::span<const SideContact> sides, double dt,
                                 const PlanarState* guess = nullptr,
                                 double enough_share = 0.0) noexcept;

}  // namespace pcavr::detail
