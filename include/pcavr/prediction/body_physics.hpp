// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pcavr/core/gravity.hpp"
#include "pcavr/friction/limit_surface.hpp"
#include "pcavr/friction/slider.hpp"
#include "pcavr/geometry/pose.hpp"
#include "pcavr/identification/object_parameters.hpp"
#include "pcavr/identification/sliding.hpp"
#include "pcavr/model/cad_model.hpp"

namespace pcavr {

/// All physical parameters of a predicted body.
struct BodyPhysics {
  FrictionParameters friction;   ///< of the support, under the body's own weight
  Compliance contact;            ///< between tip and body
  double tool_friction = 0.3;    ///< coefficient between tip and body, >= 0
  double friction_radius = 0.0;  ///< maximum friction moment over maximum friction force [m], > 0
  /// In the body's planar axes (see heading_of); only its shape is used, its force is scaled to the
  /// friction above. Empty: the ellipsoid of friction_radius.
  std::optional<LimitSurface> limit_surface = {};
};

/// Identified parameters completed by defaults, and the names of those. The defaults are
/// conservative: friction rather too high, so that no body moves in the prediction before it does
/// in reality. A limit surface that is not known is that of uniform pressure on the convex hull of
/// the lowest face, scaled to the friction radius.
struct CompletedPhysics {
  BodyPhysics physics;
  std::vector<std::string> assumed;  ///< names of the parameters that have a default value
};
/// `T_base_object` is the pose in which the body stands on its support (its lowest face counts as
/// the patch). Throws ContractError where a given parameter is not physical.
[[nodiscard]] CompletedPhysics complete_physics(const ObjectParameters& known,
                                                const CadModel& model, const Pose& T_base_object,
                                                double gravity = kStandardGravity);

/// The yaw [rad] about base z of a body's planar axes: its object frame's x axis projected on the
/// horizontal plane, or its y axis where x is steeper than 60 degrees. Origin of the planar
/// axes: the centre of mass. The frame of `limit_surface`.
[[nodiscard]] double heading_of(const Pose& T_base_object);

}  // namespace pcavr
