// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>

#include <Eigen/Core>

namespace pcavr {

/// By how much the tip falls short of its setpoint under a force, as every arm's does:
/// setpoint - tip = compliance (force - delay force rate) + lag speed. An object that sticks and
/// slips makes the arm swing, which follows such forces less than steady ones, and its damping
/// delays it: so the samples are averaged over 0.2 s, and the rate counts. All three are found by
/// least squares from slow motion in contact, without the means over the last second: a constant
/// offset of tip or force does not matter. Newer contacts replace older ones. Not thread-safe.
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
    Eigen::Vector3d shortfall = Eigen::Vector3d::Zero();   ///< [m]
    Eigen::Vector3d force = Eigen::Vector3d::Zero();       ///< [N]
    Eigen::Vector3d speed = Eigen::Vector3d::Zero();       ///< [m/s]
    Eigen::Vector3d force_rate = Eigen::Vector3d::Zero();  ///< [N/s]
  };
  struct Sample {
    double t = 0.0;
    Row row;  ///< without a rate
  };

  [[nodiscard]] std::optional<Eigen::Vector3d> setpoint_at(double t) const;
  /// The mean of the newest samples, with the rate; empty until they span the time of a mean.
  [[nodiscard]] std::optional<Row> averaged() const;
  void forget_means();
  void add(const Row& row, double dt);

  std::deque<Setpoint> setpoints_;
  std::optional<double> last_ = {};  ///< [s] the newest sample
  std::deque<Sample> newest_;
  Row mean_;
  double mean_time_ = 0.0;  ///< [s] over which it was taken
  // Sums over rows and time, of force, speed and force rate.
  Eigen::Matrix3d normal_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right_ = Eigen::Vector3d::Zero();
  double squares_ = 0.0;  ///< of the shortfall
  double time_ = 0.0;     ///< [s]
  std::optional<double> value_ = {};
};

}  // namespace pcavr
