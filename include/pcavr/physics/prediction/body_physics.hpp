// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/gravity.hpp"
#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/physics/friction/limit_surface.hpp"
#include "pcavr/physics/friction/slider.hpp"
#include "pcavr/physics/object/object_parameters.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// All physical parameters of a predicted body.
struct BodyPhysics {
  FrictionParameters friction;  ///< of the support, under the body's own weight
  HuntCrossley contact;         ///< between tip and body
  /// m [kg] of mass_damper_spring: its inertia is rendered to the hand, and does not move the body.
  double contact_mass = 0.0;
  /// Offset of the touched surface beyond the CAD body's [m], in base axes at the body's first
  /// pose.
  Eigen::Vector3d surface_offset = Eigen::Vector3d::Zero();
  /// [m/s] v_s: sliding friction is F_C + (F_M - F_C) exp(-(v / v_s)^2) + B v, which rises to F_M
  /// again as the body stops [Stribeck 1902; Canudas de Wit et al. 1995]; 0: F_C + B v.
  double stribeck_speed = 0.0;
  double tool_friction = 0.3;    ///< coefficient between tip and body, >= 0
  double friction_radius = 0.0;  ///< maximum friction moment over maximum friction force [m], > 0
  /// The limit surface in the body's planar axes (see heading_of). Only its shape is used; its
  /// force is scaled to the friction above. Empty: the ellipsoid of friction_radius.
  std::optional<LimitSurface> limit_surface = {};
};

/// Assumptions about a body where nothing is known: by default a wooden object, or a filled box or
/// tin, on a table.
struct PhysicsDefaults {
  PhysicsDefaults();
  double density;                  ///< [kg/m^3] of the CAD body's volume
  double sliding_coefficient;      ///< mu on the support
  double static_to_kinetic_ratio;  ///< F_M over the Coulomb force, >= 1
  double stribeck_speed;    ///< [m/s] over which friction falls from F_M to the Coulomb force
  double tool_friction;     ///< coefficient between tip and body
  double penetration;       ///< [m] of the tip when the body breaks loose
  double contact_exponent;  ///< n of the contact law
  double damping_ratio;     ///< of the body on the contact's spring
  double patch_height;      ///< [m] vertices so close to the lowest one touch the support
};
[[nodiscard]] OptionSection section_of(PhysicsDefaults& options);

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
                                                double gravity = kStandardGravity,
                                                const PhysicsDefaults& defaults = {});

/// The same of a body that does not move: of its physics only contact and tool friction are used,
/// so that only those are named where assumed.
[[nodiscard]] CompletedPhysics complete_immovable_physics(const ObjectParameters& known,
                                                          const CadModel& model,
                                                          const Pose& T_base_object,
                                                          double gravity = kStandardGravity,
                                                          const PhysicsDefaults& defaults = {});

/// The yaw [rad] about base z of a body's planar axes: its object frame's x axis projected on the
/// horizontal plane, or its y axis where x is steeper than 60 degrees. Origin of the planar
/// axes: the centre of mass. The frame of `limit_surface`.
[[nodiscard]] double heading_of(const Pose& T_base_object);

}  // namespace pcavr
