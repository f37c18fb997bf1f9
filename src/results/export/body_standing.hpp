// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/physics/prediction/body_physics.hpp"
#include "pcavr/results/export/exported_world.hpp"

namespace pcavr::detail {

/// [m] Length by which feet stand out under a body's lowest point: its own surface meets the
/// support only where it tips by more.
inline constexpr double kFootProtrusion = 1e-4;

/// [m] Of the body's lowest point, its surface where the contact has it, along a unit vector.
[[nodiscard]] double lowest_height(const ExportedBody& body, const Eigen::Vector3d& up_base);

/// A support plane as a box that all bodies on it stand on: a body's lowest point is at least
/// kFootProtrusion over it. The box is lowered by what the scan lies higher than that [m].
struct LoweredSupport {
  ExportedSupport box;
  double lowered = 0.0;
};
[[nodiscard]] LoweredSupport support_box_of(const SupportPlane& plane,
                                            const std::vector<ExportedBody>& bodies);

/// Places the feet of a body's friction so that they touch the plane [m, along up] while the body
/// is in its recorded pose.
void place_feet(const CadModel& model, const BodyPhysics& physics, const Plane& plane_base,
                ExportedBody& body, std::vector<ExportResidual>& residuals);

}  // namespace pcavr::detail
