// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/teleop/run_teleop.hpp"

namespace pcavr {

/// Half width of the smoothing of tip and force [s]: a tenth of a push's loading time, and ten
/// samples of an ordinary sensor.
inline constexpr double kSmoothing = 0.010;

/// The tool's motion without jumps.
struct TipMotion {
  std::vector<double> t;
  std::vector<Eigen::Vector3d> p_base;
  double noise = 0.0;       ///< of one sample, largest axis [m]
  std::size_t jumps = 0;    ///< samples left out
  double first_jump = 0.0;  ///< [s]

  /// On straight lines between samples; the first or last one outside of them.
  [[nodiscard]] Eigen::Vector3d at(double time) const;
};

/// A sample that lies where no arm gets in the time since the last good one is left out; a tool
/// that stays there for longer than a tenth of a second is believed.
[[nodiscard]] TipMotion clean_tip(const TeleopInput& input);

/// Where the tip is at `count` instants from `start` on, `step` [s] apart, smoothed over +-20 ms:
/// what a pose sensor's noise adds to a hand's motion would be felt as force.
[[nodiscard]] std::vector<Eigen::Vector3d> command_of(const TipMotion& tip, double start,
                                                      double step, std::size_t count);

/// A line for the report.
[[nodiscard]] std::string describe_jumps(const TipMotion& tip);

/// Force and tip at the force's stamps, smoothed alike over a window about each instant. What a
/// live site knows of an instant it knows `lag` later; the replay looks no further ahead than that.
/// (The size of a sensor's noise is taken over the whole recording: a property known beforehand.)
struct ForceSignal {
  std::vector<double> t;
  std::vector<Eigen::Vector3d> clean_base;   ///< spikes out; bias and drift are in [N]
  std::vector<Eigen::Vector3d> smooth_base;  ///< [N]
  std::vector<Eigen::Vector3d> p_base_tip;   ///< smoothed alike [m]
  double noise = 0.0;                        ///< of one sample, largest axis [N]
  double smooth_noise = 0.0;                 ///< of a smoothed one's size [N]
  double correlated = 1.0;                   ///< smoothed samples that count as one
  double lag = 0.0;                          ///< [s]

  [[nodiscard]] bool empty() const { return t.empty(); }
};

/// `offset` [s] is how much later the force's clock runs than the tool's: it is taken off.
[[nodiscard]] ForceSignal smooth_force(const TeleopInput& input, const TipMotion& tip,
                                       double offset);

}  // namespace pcavr
