// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "pcavr/physics/friction/limit_surface.hpp"
#include "pcavr/physics/friction/slider.hpp"

namespace pcavr {

/// A body with inertia that slides and rotates on a plane, with the three phases of step_slider.
/// Axes: the surface's are fixed to the body, its origin the centre of mass; state and load are in
/// the plane's own axes. Plain values; nothing here allocates or throws.
struct PlanarFriction {
  double mass = 1.0;      ///< [kg], > 0
  double inertia = 0.01;  ///< about the vertical through the centre of mass [kg m^2], > 0
  LimitSurface sliding;   ///< what friction bears while the body slides
  double static_to_kinetic_ratio = 1.0;  ///< F_M over the Coulomb force, >= 1
  double static_to_kinetic_std = 0.0;    ///< STD of F_M, over the Coulomb force, >= 0
  double viscous = 0.0;                  ///< [N s/m], >= 0
  double viscous_turning = 0.0;          ///< [N m s], >= 0
};

struct PlanarState {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< of the centre of mass [m]
  double yaw = 0.0;                                    ///< [rad]
  Eigen::Vector3d twist = Eigen::Vector3d::Zero();     ///< [vx vy omega]; exactly 0 unless sliding
  FrictionPhase phase = FrictionPhase::static_contact;
};

struct PlanarStep {
  PlanarState state;  ///< at the end of the step
  /// Wrench on the body, plane's axes: its mean over the step, or static friction at the end.
  Eigen::Vector3d friction = Eigen::Vector3d::Zero();
};

/// Moves the body by dt [s] > 0 under `load`, all wrenches but friction's, constant over the step,
/// [fx fy m] at the centre of mass. Implicit midpoint rule: friction is the wrench on the surface
/// that belongs to the mean twist, found as the projection on the surface (its nearest point) in
/// the metric of the mass. So a step is stable at any dt, a static body does not creep, friction is
/// passive (adds no energy), and while the body slides the error is of second order in dt.
[[nodiscard]] PlanarStep step_planar(const PlanarFriction& friction, const PlanarState& state,
                                     const Eigen::Vector3d& load, double dt) noexcept;

}  // namespace pcavr
