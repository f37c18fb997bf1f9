// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "pcavr/robots/calibration/clock_offset.hpp"

#include "velocity_signal.hpp"

namespace pcavr {

/// Fewer say nothing about a clock.
inline constexpr std::size_t kMinClockSamples = 40;

/// Turn, offset, drift and step of a clock by Gauss-Newton, from a start near it: the velocities of
/// a, at the samples' times by that clock, against those of b.
class ClockFit {
 public:
  ClockFit(const VelocitySignal& a, const VelocitySamples& samples);

  /// Drift and step are estimated where `start` has them, a step at its instant. Which samples are
  /// compared depends on the clock.
  [[nodiscard]] ClockOffset fit(const ClockOffset& start);

  /// The sum of Huber's loss of the last fit's residuals, per sample: residuals count by their
  /// squares up to `unit` [of the velocity], linearly beyond.
  [[nodiscard]] double mean_loss(double unit) const;
  /// Beyond this residuals count linearly, by the last fit.
  [[nodiscard]] double loss_unit() const;
  /// Part of the step's information that offset, drift and turn leave [(rad/s)^2/s^2 per sample].
  [[nodiscard]] double step_information() const;

 private:
  bool look_up();
  Eigen::VectorXd solve();
  void apply(const Eigen::VectorXd& step);
  void weigh();
  void state_std();
  [[nodiscard]] Eigen::MatrixXd score_variance(double length) const;
  [[nodiscard]] Eigen::Index drift_column() const { return 1; }
  [[nodiscard]] Eigen::Index step_column() const { return clock_.drift ? 2 : 1; }

  const VelocitySignal& a_;
  const VelocitySamples& samples_;
  double derivative_step_;
  ClockOffset clock_;
  std::vector<double> at_, weights_;
  std::vector<Eigen::Vector3d> a_values_, b_values_, slopes_, residuals_;
  std::vector<Eigen::Matrix<double, 3, Eigen::Dynamic>> rows_;
  Eigen::MatrixXd normal_;
};

}  // namespace pcavr
