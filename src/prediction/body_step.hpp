// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "prediction/tip_contact.hpp"

namespace pcavr::detail {

/// Moves one body by dt [s] under the tip's contact and the support's friction.
[[nodiscard]] BodyState step_body(const UprightBody& body, const BodyState& state,
                                  const TipPath& tip, double dt) noexcept;

}  // namespace pcavr::detail
