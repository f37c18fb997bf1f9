// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "pcavr/physics/friction/planar_slider.hpp"

#include "physics/prediction/upright_body.hpp"

namespace pcavr::detail {

/// The state to which a slow push would have brought a body that the tip's sphere, of `radius` [m]
/// at `p_base_tip`, overlaps: the tip is then as deep in it as the Coulomb force presses it. The
/// push is at an even speed, so that the body turns, too. `entry_normal`: see BodyState.
[[nodiscard]] PlanarState pushed_out(const UprightBody& body, const PlanarState& planar,
                                     const Eigen::Vector3d& p_base_tip, double radius,
                                     const Eigen::Vector3d& entry_normal) noexcept;

}  // namespace pcavr::detail
