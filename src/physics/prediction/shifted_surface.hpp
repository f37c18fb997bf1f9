// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/physics/friction/limit_surface.hpp"

namespace pcavr::detail {

/// The limit surface of the same support moved by `centre` [m], its axes and origin kept: its
/// moments are then about that point. No allocation.
[[nodiscard]] LimitSurface shifted(const LimitSurface& surface,
                                   const Eigen::Vector2d& centre) noexcept;

}  // namespace pcavr::detail
