// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/physics/friction/limit_surface.hpp"

namespace pcavr::detail {

/// Counter-clockwise outlines about the centre of mass, base axes [m].
struct SupportPatch {
  std::vector<Eigen::Vector2d> outline;     ///< of what is in contact with the support
  std::vector<Eigen::Vector2d> projection;  ///< of the whole body, on the horizontal plane
};
/// Vertices within `height` [m] of the lowest one are in contact.
[[nodiscard]] SupportPatch support_patch(const CadModel& model, const Pose& T_base_object,
                                         double height);

/// The mean_radius under uniform pressure [m].
[[nodiscard]] double radius_of(const SupportPatch& patch);

/// The limit surface of uniform pressure on the outline, scaled to the mean radius `radius` [m], in
/// axes rotated by `heading` [rad]; force 1 N. A sum over the patch's cells, and a quartic fitted
/// to it. Empty where the outline has no area.
[[nodiscard]] std::optional<LimitSurface> surface_of(const SupportPatch& patch, double radius,
                                                     double heading);

}  // namespace pcavr::detail
