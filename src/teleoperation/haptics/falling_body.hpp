// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pcavr/base/geometry/pose.hpp"

#include "teleoperation/haptics/floor_heights.hpp"
#include "teleoperation/haptics/supports.hpp"

namespace pcavr::detail {

/// A body whose centre of mass has left its support: it tips over the edge, as an
/// inverted pendulum, and then falls freely until it rests on what the scan shows below, on the
/// face that is nearest, or is out of view. No other collisions.
class FallingBody {
 public:
  struct Start {
    Pose T_base_object;
    Eigen::Vector3d centre_of_mass_object = Eigen::Vector3d::Zero();
    Eigen::Vector2d v_base = Eigen::Vector2d::Zero();  ///< [m/s] of the centre of mass
    double gyration_radius = 0.05;                     ///< [m], > 0
    Supports::Edge edge;
    double max_tilt = 0.0;         ///< [rad] about the edge: farther, it slips off
    double max_fall_height = 0.0;  ///< [m] after falling this far it stops: out of view
    Eigen::AlignedBox3d bounds_object;
  };
  explicit FallingBody(const Start& start) noexcept;

  void step(double gravity, double dt, const FloorHeights& floor) noexcept;
  [[nodiscard]] bool is_resting() const { return is_resting_; }
  [[nodiscard]] Pose T_base_object() const;

 private:
  void tip_over(double gravity, double dt) noexcept;
  void land(double floor) noexcept;
  [[nodiscard]] double lowest() const;

  Eigen::Vector3d centre_of_mass_object_;
  Eigen::Vector3d edge_;
  Eigen::Vector3d along_;
  double gyration_radius_;
  double start_height_;
  double max_tilt_;
  double max_fall_height_;
  Eigen::AlignedBox3d bounds_object_;
  bool is_free_ = false;
  bool is_resting_ = false;
  Eigen::Vector3d centre_;  ///< of mass, in base
  Eigen::Vector3d v_;       ///< [m/s]
  Eigen::Quaterniond q_base_object_;
  double tilt_ = 0.0;       ///< [rad] about the edge
  double tilt_rate_ = 0.0;  ///< [rad/s]
};

}  // namespace pcavr::detail
