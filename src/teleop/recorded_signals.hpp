// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/teleop/run_teleop.hpp"

namespace pcavr {

/// Half width of the smoothing of tip and force [s]: a tenth of a push's loading time, and ten
/// samples of an ordinary sensor.
inline constexpr double kSmoothing = 0.010;

/// How many of the stamps from `first` on lie within kCalibrationTime of that one.
[[nodiscard]] std::size_t calibration_count(std::span<const double> t, std::size_t first = 0);

/// The tool's motion without jumps. Views the input that it was made of, which must outlive it.
struct TipMotion {
  std::span<const double> t;
  std::span<const Eigen::Vector3d> p_base;
  double noise = 0.0;       ///< of one sample, largest axis [m]
  std::size_t jumps = 0;    ///< samples left out
  double first_jump = 0.0;  ///< [s]

  TipMotion() = default;
  TipMotion(TipMotion&&) = default;
  TipMotion& operator=(TipMotion&&) = default;
  TipMotion(const TipMotion&) = delete;
  TipMotion& operator=(const TipMotion&) = delete;
  ~TipMotion() = default;

  /// On straight lines between samples; the first or last one outside of them.
  [[nodiscard]] Eigen::Vector3d at(double time) const;

  /// What the spans view where samples had to be left out; else empty.
  std::vector<double> t_without_jumps = {};
  std::vector<Eigen::Vector3d> p_base_without_jumps = {};
};

/// A sample that lies where no arm gets in the time since the last good one is left out; a tool
/// that stays there for longer than a tenth of a second is believed.
[[nodiscard]] TipMotion clean_tip(const TeleopInput& input);

/// Where the tip is at instants `step` [s] apart, smoothed over +-20 ms: what a pose sensor's noise
/// adds to a hand's motion would be felt as force. Worked out some seconds at a time.
class CommandPath {
 public:
  /// Keeps a reference; `tip` must outlive it and have two samples or more.
  CommandPath(const TipMotion& tip, double start, double step);
  /// At start + step * cycle. Cheapest in ascending order.
  [[nodiscard]] Eigen::Vector3d at(std::size_t cycle);

 private:
  void work_out(std::size_t block);

  const TipMotion& tip_;
  double start_;
  double step_;
  double half_width_;
  std::size_t block_ = ~std::size_t{0};
  std::vector<Eigen::Vector3d> path_;  ///< of the block's cycles
};

/// A line for the report.
[[nodiscard]] std::string describe_jumps(const TipMotion& tip);

/// Force and tip at the force's stamps, smoothed alike over a window about each instant. What a
/// live site knows of an instant it knows `lag` later; the replay looks no further ahead than that.
/// (The size of a sensor's noise is taken over kCalibrationTime: a property known beforehand.)
/// Samples are worked out some thousand at a time, and can be forgotten.
class ForceSignal {
 public:
  struct Sample {
    double t = 0.0;
    Eigen::Vector3d clean_base = Eigen::Vector3d::Zero();   ///< spikes out; bias and drift in [N]
    Eigen::Vector3d smooth_base = Eigen::Vector3d::Zero();  ///< [N]
    Eigen::Vector3d p_base_tip = Eigen::Vector3d::Zero();   ///< smoothed alike [m]
  };
  /// A stretch of the signal.
  struct Record {
    std::span<const double> t;
    std::span<const Eigen::Vector3d> clean_base;
  };

  /// `offset` [s] is how much later the force's clock runs than the tool's: it is taken off. Keeps
  /// references, which must outlive it. Empty where there is too little to smooth.
  ForceSignal(const TeleopInput& input, const TipMotion& tip, double offset);

  [[nodiscard]] bool empty() const { return count_ == 0; }
  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] double t(std::size_t index) const { return input_.t_force[index] - offset_; }
  [[nodiscard]] double interval() const { return interval_; }  ///< mean [s]
  [[nodiscard]] double noise() const { return noise_; }        ///< of one sample, largest axis [N]
  [[nodiscard]] double smooth_noise() const {
    return smooth_noise_;
  }  ///< of a smoothed one's size [N]
  [[nodiscard]] double correlated() const {
    return correlated_;
  }                                                  ///< smoothed ones that count as one
  [[nodiscard]] double lag() const { return lag_; }  ///< [s]

  /// Call in ascending order: works out what is needed. `index` < size(), and not forgotten.
  [[nodiscard]] Sample at(std::size_t index);
  /// What lies in [from, to], of what was worked out and not forgotten.
  [[nodiscard]] Record between(double from, double to) const;
  /// Samples before `time` will not be asked for again.
  void forget_before(double time);

 private:
  void measure_noise();
  void extend();

  const TeleopInput& input_;
  const TipMotion& tip_;
  double offset_ = 0.0;
  std::size_t count_ = 0;
  double interval_ = 0.0, half_width_ = 0.0, lag_ = 0.0;
  double noise_ = 0.0, smooth_noise_ = 0.0, correlated_ = 1.0;
  std::array<double, 3> spike_noise_{};  ///< [N] by axis, no less than which a spike is judged by
  std::size_t first_ = 0;                ///< index of the first sample kept
  std::vector<double> t_;
  std::vector<Eigen::Vector3d> clean_base_, smooth_base_, p_base_tip_;
};

}  // namespace pcavr
