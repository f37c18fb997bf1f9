// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/recordings/recording/joint_log.hpp"
#include "pcavr/robots/robot_identification/presliding.hpp"

namespace pcavr {

/// Candidates for the speed over which friction changes its sign [rad/s]: from the resolution of
/// encoders to the smoothing of the published identifications.
inline constexpr std::array<double, 6> kSmoothingSpeeds{0.003, 0.01, 0.02, 0.035, 0.05, 0.1};

struct OptionSection;  // core/options.hpp

/// Defaults and ranges: src/robots/robot_identification/options.cpp.
struct JointSignalOptions {
  JointSignalOptions();
  double bandwidth;            ///< [Hz] -6 dB of the zero-phase filter; 0: from the motion
  double bandwidth_of_motion;  ///< bandwidth over the frequency below which the motion lies
  double rows_per_period;      ///< rows kept per period of the bandwidth (decimation)
  double max_rest;             ///< [s] longer ones of all joints are left out
  double max_gap;              ///< [s] longer intervals without rows are left out
};
[[nodiscard]] OptionSection section_of(JointSignalOptions& options);

/// A log on a uniform grid, filtered, with derivatives; one row an instant, one column a joint.
struct JointSignals {
  double interval = 0.0;              ///< [s] between rows
  double bandwidth = 0.0;             ///< [Hz] of all signals, -6 dB
  double motion_frequency = 0.0;      ///< [Hz] the motion's power above it is 1e-5 of the whole
  std::size_t rows_at_rest = 0;       ///< left out: friction at rest is not determined
  double log_interval = 0.0;          ///< [s] median of the log
  bool is_sign_changed = false;       ///< torques are those of the log times -1
  bool is_velocity_recorded = false;  ///< else it is the positions' derivative
  double velocity_lag = 0.0;          ///< [s] of recorded velocities after positions
  std::optional<double> velocity_disagreement;  ///< rms, relative; where they are recorded
  std::vector<double> t;                        ///< [s] from the log's first row
  std::vector<int> lines;                       ///< of the log's file, of the nearest row
  Eigen::MatrixXd position;                     ///< [rad]
  Eigen::MatrixXd velocity;                     ///< [rad/s]
  Eigen::MatrixXd acceleration;                 ///< [rad/s^2]
  Eigen::MatrixXd torque;                       ///< [N m]
  Eigen::MatrixXd torque_rate;                  ///< [N m/s]
  /// tanh(velocity / speed) with each of kSmoothingSpeeds, filtered as the torques are: of a sign's
  /// steps the filter leaves slopes, which would else be taken for friction that grows with the
  /// speed.
  std::array<Eigen::MatrixXd, kSmoothingSpeeds.size()> smoothed_sign;
  /// Signs of friction with each of kPreslidingDisplacements, filtered as the torques are.
  std::array<Eigen::MatrixXd, kPreslidingDisplacements.size()> presliding_sign;
};

/// Butterworth low-pass of order 4, forward and backward: no phase, -6 dB at `bandwidth` [Hz]. At
/// both ends the signal is continued by its point reflection. `rate` [Hz] > 2 bandwidth.
/// [Gustafsson 1996]
[[nodiscard]] Eigen::VectorXd filter_zero_phase(const Eigen::VectorXd& values, double rate,
                                                double bandwidth);

/// The derivative of a uniformly sampled signal by central differences of sixth order: relative
/// error below 0.1 % up to a tenth of the rate. Lower order at the ends.
[[nodiscard]] Eigen::VectorXd differentiate(const Eigen::VectorXd& values, double interval);

/// Values at the instants `at` by cubic Hermite interpolation with slopes from central differences.
/// Both ascending; constant outside.
[[nodiscard]] Eigen::VectorXd interpolate(const std::vector<double>& t,
                                          const Eigen::VectorXd& values,
                                          const std::vector<double>& at);

/// Frequency [Hz] above which lies 1e-5 of the power of all columns about their means, noise left
/// out: amplitudes of 0.3 % of the motion's.
[[nodiscard]] double motion_frequency(const Eigen::MatrixXd& position, double interval);

/// Resamples, filters and differentiates. Velocities of the log are used where they agree with the
/// positions and give less noisy accelerations; the delay of their filter is estimated and removed.
/// Rows within 1/bandwidth of the ends and of
/// gaps are left out. Throws ContractError for fewer than 8 rows.
[[nodiscard]] JointSignals joint_signals(const JointLog& log, const JointSignalOptions& options);

}  // namespace pcavr
