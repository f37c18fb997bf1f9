// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/friction/limit_surface.hpp"
#include "pcavr/geometry/pose.hpp"
#include "pcavr/model/cad_model.hpp"

namespace pcavr::detail {

/// Counter-clockwise outlines about the centre of mass, base axes [m].
struct SupportPatch {
  std::vector<Eigen::Vector2d> outline;  ///< of what touches the support
  std::vector<Eigen::Vector2d> shadow;   ///< of the whole body, seen from above
};
[[nodiscard]] SupportPatch support_patch(const CadModel& model, const Pose& T_base_object);

/// How far out it bears on average under even pressure [m].
[[nodiscard]] double radius_of(const SupportPatch& patch);

/// What friction bears under even pressure on the outline, stretched so that it bears `radius` [m]
/// out on average, in axes turned by `heading` [rad]; force 1 N. A sum over the patch's parts, and
/// a quartic fitted to it. Nothing where the outline has no area.
[[nodiscard]] std::optional<LimitSurface> surface_of(const SupportPatch& patch, double radius,
                                                     double heading);

}  // namespace pcavr::detail
