// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <Eigen/Core>

#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/physics/friction/planar_slider.hpp"
#include "pcavr/physics/prediction/closest_surface.hpp"
#include "pcavr/physics/prediction/predicted_world.hpp"

namespace pcavr::detail {

[[nodiscard]] bool is_physical(const BodyPhysics& physics) noexcept;

/// A body that slides upright over the support, with all its constants. Body axes: parallel to base
/// at the start, z the height in base, origin on the vertical through its centre of mass. So yaw
/// and the centre's position determine the whole pose.
class UprightBody {
 public:
  /// `max_contact_force` [N] > 0 of the tip: one that jumps into a stiff body would otherwise
  /// accelerate it without limit.
  UprightBody(const WorldBody& body, double gravity, double max_contact_force);

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] bool is_movable() const { return is_movable_; }
  [[nodiscard]] const ClosestSurface& surface() const { return surface_; }
  [[nodiscard]] const BodyPhysics& physics() const { return physics_; }
  [[nodiscard]] double max_contact_force() const { return max_contact_force_; }  ///< [N]
  void set_physics(const BodyPhysics& physics);

  [[nodiscard]] Pose pose_of(const PlanarState& planar) const;
  /// The yaw is the one closest to `yaw_near` (unwrapped).
  [[nodiscard]] PlanarState at_rest_in(const Pose& T_base_object, double yaw_near) const;
  [[nodiscard]] PlanarState start() const { return at_rest_in(T_base_object_start_, 0.0); }

  /// The support's friction under a `force` [N] on the body, base axes, at `arm` [m] from the
  /// centre of mass and `height` [m] in base: vertical force adds to the weight, and a push above
  /// the support shifts the centre of pressure ahead.
  [[nodiscard]] PlanarFriction friction_under(const Eigen::Vector3d& force,
                                              const Eigen::Vector2d& arm, double height,
                                              double yaw) const noexcept;
  /// Normal load on the support over the weight, under an additional force `down` [N].
  [[nodiscard]] double weight_share(double down) const noexcept;
  /// The step by step_planar, in the axes of the body's limit surface.
  [[nodiscard]] PlanarStep step(const PlanarFriction& friction, const PlanarState& state,
                                const Eigen::Vector3d& load, double dt) const noexcept;
  /// `load` relative to the limit surface of sliding; see level.
  [[nodiscard]] double level_of(const PlanarFriction& friction, double yaw,
                                const Eigen::Vector3d& load) const noexcept;

  /// The twist of the body, base axes, whose point at `arm` [m] a finger pushes slowly along
  /// `direction`, into the face that it touches, at 1 m/s.
  [[nodiscard]] Eigen::Vector3d slow_push_twist(const Eigen::Vector2d& arm,
                                                const Eigen::Vector2d& direction,
                                                double yaw) const noexcept;

  [[nodiscard]] double gyration_radius() const { return gyration_radius_; }
  /// Stiffness of the tip's contact at the force at which the body breaks loose [N/m].
  [[nodiscard]] double working_stiffness() const { return working_stiffness_; }
  /// Penetration of the tip, at rest, under the Coulomb force and the static friction limit [m].
  [[nodiscard]] double sliding_depth() const { return sliding_depth_; }
  [[nodiscard]] double static_limit_depth() const { return static_limit_depth_; }
  /// Penetration up to which the tip presses on the face through which it came in, also where
  /// another one is closer [m].
  [[nodiscard]] double max_entry_depth() const { return max_entry_depth_; }
  /// Sliding friction without its viscous part, over the Coulomb force, at a twist.
  [[nodiscard]] double stribeck_factor(const Eigen::Vector3d& twist) const noexcept;
  /// Share of the static friction limit above which the phase is critical.
  [[nodiscard]] double critical_share() const { return critical_share_; }

 private:
  std::string name_;
  bool is_movable_;
  Pose T_base_object_start_;
  Eigen::Vector3d centre_of_mass_object_;
  ClosestSurface surface_;
  double heading_;          ///< of the friction's axes at the start [rad]
  double gyration_radius_;  ///< about the vertical through the centre of mass [m]
  double gravity_;
  double max_contact_force_;
  double lowest_;  ///< height of the lowest point in base [m]
  BodyPhysics physics_;
  PlanarFriction friction_;
  double working_stiffness_ = 0.0;
  double sliding_depth_ = 0.0;
  double static_limit_depth_ = 0.0;
  double max_entry_depth_ = 0.0;
  double critical_share_ = 1.0;
};

}  // namespace pcavr::detail
