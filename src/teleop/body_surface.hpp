// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "pcavr/geometry/pose.hpp"
#include "pcavr/model/cad_model.hpp"

namespace pcavr {

/// Distance and direction from the tool's tip to a body.
struct Reach {
  double clearance = 0.0;  ///< between their surfaces [m]; below 0: penetration
  Eigen::Vector3d direction_base = Eigen::Vector3d::UnitX();  ///< unit, from the tip into the body
};

/// Maximum distance that is searched [m].
inline constexpr double kFarAway = 0.1;

/// Closest-point queries to a body's CAD surface.
class BodySurface {
 public:
  explicit BodySurface(const CadModel& model) : surface_(model.mesh_object) {}

  /// Clearance kFarAway if the body is farther away.
  [[nodiscard]] Reach reach(const Pose& T_base_object, const Eigen::Vector3d& p_base_tip,
                            double tool_radius) const;

 private:
  SurfaceQuery surface_;
};

}  // namespace pcavr
