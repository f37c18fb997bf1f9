// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "pcavr/geometry/pose.hpp"
#include "pcavr/model/cad_model.hpp"

namespace pcavr {

/// How the tool's tip stands to a body.
struct Reach {
  double clearance = 0.0;  ///< between their surfaces [m]; below 0 the tip presses in
  Eigen::Vector3d direction_base = Eigen::Vector3d::UnitX();  ///< unit, from the tip into the body
};

/// Further away than this is far [m].
inline constexpr double kFarAway = 0.1;

/// A body's CAD surface, asked for its nearest point.
class BodySurface {
 public:
  explicit BodySurface(const CadModel& model) : surface_(model.mesh_object) {}

  /// Clearance kFarAway where the body is no nearer than that.
  [[nodiscard]] Reach reach(const Pose& T_base_object, const Eigen::Vector3d& p_base_tip,
                            double tool_radius) const;

 private:
  SurfaceQuery surface_;
};

}  // namespace pcavr
