// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pcavr/physics/identification/parameter.hpp"
#include "pcavr/physics/identification/path_view.hpp"

namespace pcavr {

/// A contact along the local direction of its force.
struct LocalContact {
  std::span<const double> t;  ///< [s] those it was made of
  std::vector<double> tool;   ///< [m] the tip's path along the direction, from 0
  std::vector<double> force;  ///< [N] along the direction

  [[nodiscard]] ForceMotion series(std::optional<double> tool_noise) const {
    return {t, tool, force, tool_noise};
  }
};

/// The contact of a tip that travels over a surface whose normal changes under it. Along one fixed
/// direction, a press on a part that is tilted by an angle a would give way by a factor cos(a)^2
/// too little. The direction at each instant is that of the force's mean within `half_width` [s];
/// friction along the travel tilts it, too. Stamps [s] ascending strictly, forces [N] that the tool
/// exerts, without bias, in the base frame.
[[nodiscard]] LocalContact along_local_force(std::span<const double> t,
                                             std::span<const Eigen::Vector3d> force_base,
                                             const PathView& tip, double half_width);

}  // namespace pcavr
