// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>

#include <Eigen/Core>

namespace pcavr {

/// By how much the tip falls short of its setpoint under a force, as every arm's does:
/// setpoint - tip = compliance force + lag speed. Both are found by least squares from the samples
/// of slow motion in contact, without their means over the last second: a constant offset of tip or
/// force does not matter. Newer contacts replace older ones. Not thread-safe.
class ToolCompliance {
 public:
  /// The setpoint of the tip from `t` [s] on; ascending.
  void add_setpoint(double t, const Eigen::Vector3d& p_base);
  /// What was measured at `t` [s]: the tip [m], and the force that it exerts [N]; ascending.
  void add_sample(double t, const Eigen::Vector3d& p_base_tip, const Eigen::Vector3d& force_base);
  /// [m/N] Once it is known to a third. A tip that is driven by something else has none.
  [[nodiscard]] std::optional<double> value() const { return value_; }

 private:
  struct Setpoint {
    double t = 0.0;
    Eigen::Vector3d p_base;
  };
  /// The rows of the regression: each a vector.
  struct Row {
    Eigen::Vector3d shortfall = Eigen::Vector3d::Zero();  ///< [m]
    Eigen::Vector3d force = Eigen::Vector3d::Zero();      ///< [N]
    Eigen::Vector3d speed = Eigen::Vector3d::Zero();      ///< [m/s]
  };

  [[nodiscard]] std::optional<Eigen::Vector3d> setpoint_at(double t) const;
  void add(const Row& row, double dt);

  std::deque<Setpoint> setpoints_;
  std::optional<double> last_ = {};  ///< [s] the newest sample
  Row mean_;
  double mean_time_ = 0.0;  ///< [s] over which it was taken
  // Sums over rows and time.
  Eigen::Matrix2d normal_ = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right_ = Eigen::Vector2d::Zero();
  double squares_ = 0.0;  ///< of the shortfall
  double time_ = 0.0;     ///< [s]
  std::optional<double> value_ = {};
};

}  // namespace pcavr
