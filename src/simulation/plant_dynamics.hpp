// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include <Eigen/Core>

#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/simulation/plant.hpp"

#include "simulation/plant_phases.hpp"
#include "simulation/support.hpp"
#include "simulation/tip_contact.hpp"

namespace pcavr::simulation {

/// Planar rigid-body dynamics of one body with support friction and tip contact.
class BodyDynamics {
 public:
  BodyDynamics(const PlantBody& body, double tip_radius);

  TipLoad advance(const Tip& tip, double dt);

  [[nodiscard]] Pose pose() const;
  /// Velocity of the centre of mass.
  [[nodiscard]] Eigen::Vector3d v_base() const { return {twist_.x(), twist_.y(), 0.0}; }
  [[nodiscard]] PlantBodyState state() const;
  [[nodiscard]] bool is_finite() const { return centre_.allFinite() && std::isfinite(yaw_); }
  /// Quantities that determine the body's phase.
  [[nodiscard]] PhaseInputs phase_inputs() const;

 private:
  [[nodiscard]] double speed() const;
  [[nodiscard]] BodyMotion motion() const;

  Support support_;
  TipContact contact_;
  double mass_;
  double inertia_ = 0.0;
  double centre_height_ = 0.0;  ///< of the centre of mass above the support [m]
  double height_;               ///< of the body's origin in base [m]
  double limit_ = 0.0;          ///< static friction over normal force
  bool is_movable_;
  bool is_resting_ = true;
  bool touches_ = false;
  double normal_ = 0.0;  ///< force on the support [N]
  Eigen::Vector2d centre_;
  double yaw_ = 0.0;
  Eigen::Vector3d twist_ = Eigen::Vector3d::Zero();
  Eigen::Vector2d acceleration_ = Eigen::Vector2d::Zero();
  Eigen::Vector3d friction_ = Eigen::Vector3d::Zero();
};

/// The tip as a mass on a damped spring whose other end follows the command (servo compliance).
class SpringArm {
 public:
  explicit SpringArm(const PlantTool& tool);

  /// The command is at `p_base` [m] and moves at `v_base` [m/s]; `load` [N]: what the tip exerts.
  void advance(const Eigen::Vector3d& p_base, const Eigen::Vector3d& v_base,
               const Eigen::Vector3d& load, double dt);
  /// The same while the arm is released: its mass flies freely.
  void fly(const Eigen::Vector3d& load, double dt);

  [[nodiscard]] const Tip& tip() const { return tip_; }

 private:
  double rate_;  ///< [rad/s]
  double mass_;  ///< [kg] effective mass at the tip
  Tip tip_;
};

}  // namespace pcavr::simulation
