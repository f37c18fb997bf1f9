// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pcavr/inputs/tip_path.hpp"
#include "pcavr/teleop/run_teleop.hpp"

namespace pcavr {

/// Half width of the smoothing of tip and force [s]: a tenth of a push's loading time, and ten
/// samples of a typical sensor.
inline constexpr double kSmoothing = 0.010;

/// The tip's path, sampled every `step` [s] and smoothed over +-20 ms, up to +-80 ms where the
/// motion is slow: the pose sensor's noise would be rendered as force. Computed in blocks of some
/// seconds.
class CommandPath {
 public:
  /// Keeps a reference; `tip` must outlive it and have two samples or more.
  CommandPath(const TipPath& tip, double start, double step);
  /// At start + step * cycle. Cheapest in ascending order.
  [[nodiscard]] Eigen::Vector3d at(std::size_t cycle);
  /// [m/s^2], 1.2 % low at 10 Hz.
  [[nodiscard]] Eigen::Vector3d acceleration_at(std::size_t cycle);

 private:
  void compute_block(std::size_t block);

  const TipPath& tip_;
  double start_;
  double step_;
  double half_width_;
  std::size_t block_ = ~std::size_t{0};
  std::vector<Eigen::Vector3d> path_;  ///< of the block's cycles
  std::vector<Eigen::Vector3d> acceleration_;
};

/// Force and tip at the force's stamps, smoothed with the same centred window. A live site has a
/// smoothed sample `lag` later; the replay uses no newer data than that. (The sensor's noise is
/// measured over kCalibrationTime, as a property known beforehand.) Samples are computed in blocks
/// of some thousand, and can be discarded.
class ForceSignal {
 public:
  struct Sample {
    double t = 0.0;
    Eigen::Vector3d clean_base =
        Eigen::Vector3d::Zero();  ///< without spikes; with bias and drift [N]
    Eigen::Vector3d smooth_base = Eigen::Vector3d::Zero();  ///< [N]
    Eigen::Vector3d p_base_tip = Eigen::Vector3d::Zero();   ///< smoothed with the same window [m]
  };
  /// A section of the signal.
  struct Record {
    std::span<const double> t;
    std::span<const Eigen::Vector3d> clean_base;
  };

  /// `offset` [s]: the force's clock minus the tool's, which is subtracted. Keeps references to the
  /// arguments, which must outlive it. Empty if there are too few samples to smooth.
  ForceSignal(const TeleopInput& input, const TipPath& tip, double offset);

  [[nodiscard]] bool empty() const { return count_ == 0; }
  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] double t(std::size_t index) const { return input_.t_force[index] - offset_; }
  [[nodiscard]] double interval() const { return interval_; }  ///< mean [s]
  [[nodiscard]] double noise() const { return noise_; }  ///< std of one sample, largest axis [N]
  [[nodiscard]] double smooth_noise() const {
    return smooth_noise_;
  }  ///< std of a smoothed sample's norm [N]
  [[nodiscard]] double correlated() const {
    return correlated_;
  }                                                  ///< smoothed samples per independent one
  [[nodiscard]] double lag() const { return lag_; }  ///< [s]

  /// Call in ascending order: computes blocks on demand. `index` < size(), and not discarded.
  [[nodiscard]] Sample at(std::size_t index);
  /// The samples in [from, to] that were computed and not discarded.
  [[nodiscard]] Record between(double from, double to) const;
  /// Samples before `time` will not be requested again.
  void discard_before(double time);

 private:
  void measure_noise();
  void extend();

  const TeleopInput& input_;
  const TipPath& tip_;
  double offset_ = 0.0;
  std::size_t count_ = 0;
  double interval_ = 0.0, half_width_ = 0.0, lag_ = 0.0;
  double noise_ = 0.0, smooth_noise_ = 0.0, correlated_ = 1.0;
  std::array<double, 3> spike_noise_{};  ///< [N] by axis, minimum noise of the spike detection
  std::size_t first_ = 0;                ///< index of the first stored sample
  std::vector<double> t_;
  std::vector<Eigen::Vector3d> clean_base_, smooth_base_, p_base_tip_;
};

}  // namespace pcavr
