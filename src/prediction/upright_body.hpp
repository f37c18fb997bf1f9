// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <Eigen/Core>

#include "pcavr/friction/planar_slider.hpp"
#include "pcavr/geometry/pose.hpp"
#include "pcavr/prediction/predicted_world.hpp"

#include "prediction/closest_surface.hpp"

namespace pcavr::detail {

[[nodiscard]] bool is_physical(const BodyPhysics& physics) noexcept;

/// A body that slides upright over the support, with all that does not change while it does.
/// Body axes: base axes as the body stood at the start, z the height in base, origin above its
/// centre of mass. So yaw and the centre's place tell the whole pose.
class UprightBody {
 public:
  UprightBody(const WorldBody& body, double gravity);

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const ClosestSurface& surface() const { return surface_; }
  [[nodiscard]] const BodyPhysics& physics() const { return physics_; }
  void set_physics(const BodyPhysics& physics);

  [[nodiscard]] Pose pose_of(const PlanarState& planar) const;
  /// The yaw is the one next to `yaw_near`.
  [[nodiscard]] PlanarState at_rest_in(const Pose& T_base_object, double yaw_near) const;
  [[nodiscard]] PlanarState start() const { return at_rest_in(T_base_object_start_, 0.0); }

  /// The support's friction under a `force` [N] on the body, base axes, at `arm` [m] from the
  /// centre of mass and `height` [m] in base: what presses down adds to the weight, and what pushes
  /// above the support shifts the pressure ahead.
  [[nodiscard]] PlanarFriction friction_under(const Eigen::Vector3d& force,
                                              const Eigen::Vector2d& arm, double height,
                                              double yaw) const noexcept;
  /// How many times the weight bears on the support under a force `down` [N] beside it.
  [[nodiscard]] double weight_share(double down) const noexcept;
  /// step_planar, with the yaw that its surface is stated in.
  [[nodiscard]] PlanarStep step(const PlanarFriction& friction, const PlanarState& state,
                                const Eigen::Vector3d& load, double dt) const noexcept;
  /// How much of what the support's friction bears while sliding `load` needs; see level.
  [[nodiscard]] double level_of(const PlanarFriction& friction, double yaw,
                                const Eigen::Vector3d& load) const noexcept;

  [[nodiscard]] double gyration_radius() const { return gyration_radius_; }
  /// Of the tip's contact near the force at which the body breaks loose [N/m].
  [[nodiscard]] double working_stiffness() const { return working_stiffness_; }
  /// Where the tip's contact, at rest, bears the friction of sliding, and all that holds [m].
  [[nodiscard]] double sliding_depth() const { return sliding_depth_; }
  [[nodiscard]] double holding_depth() const { return holding_depth_; }
  /// Of what the support holds at rest: from here on the body is about to go.
  [[nodiscard]] double critical_share() const { return critical_share_; }

 private:
  std::string name_;
  Pose T_base_object_start_;
  Eigen::Vector3d centre_of_mass_object_;
  ClosestSurface surface_;
  double heading_;          ///< of the friction's axes at the start [rad]
  double gyration_radius_;  ///< about the vertical through the centre of mass [m]
  double gravity_;
  double foot_;  ///< height of the lowest point in base [m]
  BodyPhysics physics_;
  PlanarFriction friction_;
  double working_stiffness_ = 0.0;
  double sliding_depth_ = 0.0;
  double holding_depth_ = 0.0;
  double critical_share_ = 1.0;
};

}  // namespace pcavr::detail
