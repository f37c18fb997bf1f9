// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pcavr/physics/identification/signals.hpp"
#include "pcavr/physics/inputs/noise_tracker.hpp"
#include "pcavr/physics/inputs/tip_stream.hpp"

#include "teleoperation/teleop/force_ceiling.hpp"

namespace pcavr {

/// Force and tip at the force's stamps, as they come: single spikes removed, and both smoothed with
/// the same centred window, so that a sample is ready `lag` later. Noise and rate are measured on
/// the way. The newest samples are stored. Not thread-safe.
class ForceStream {
 public:
  struct Sample {
    double t = 0.0;  ///< [s] on the tool's clock
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

  /// `prior_noise` [N]: std of one sample until it is measured.
  explicit ForceStream(double prior_noise)
      : raw_noise_(prior_noise), clean_noise_(prior_noise), ceiling_(prior_noise) {}

  /// `t` [s] by the force's own clock, later than the one before.
  void add(double t, const Eigen::Vector3d& force_base);
  /// [s] Time by which the force's clock is ahead of the tool's: subtracted from all stamps, also
  /// of the stored samples.
  void set_offset(double offset);
  [[nodiscard]] double offset() const { return offset_; }

  /// The next sample after `after` [s] of which force and tip cover the window; empty if there is
  /// none yet. A sample that stays uncovered is passed on as it is, 50 ms after both should have
  /// come.
  [[nodiscard]] std::optional<Sample> next(double after, double now, const TipStream& tip);
  /// The stored samples in [from, to].
  [[nodiscard]] Record between(double from, double to) const;
  /// Samples before `time` [s] will not be requested again.
  void discard_before(double time);
  /// [N] Force at which the sensor has saturated in the stored time; empty: it has not.
  [[nodiscard]] std::optional<double> ceiling() const { return ceiling_.value(); }

  [[nodiscard]] double interval() const;                                 ///< mean [s]
  [[nodiscard]] double noise() const { return clean_noise_.largest(); }  ///< [N] std, largest axis
  [[nodiscard]] double smooth_noise() const;  ///< [N] std of a smoothed sample's norm
  [[nodiscard]] double correlated() const;    ///< smoothed samples per independent one
  [[nodiscard]] double lag() const;           ///< [s]

 private:
  [[nodiscard]] double half_width() const;
  [[nodiscard]] Eigen::Vector3d despiked(std::size_t index) const;
  [[nodiscard]] Sample smoothed(std::size_t index, const TipStream& tip) const;

  NoiseTracker raw_noise_, clean_noise_;
  ForceCeiling ceiling_;  ///< of raw_base_
  double offset_ = 0.0;
  std::size_t next_ = 0;
  std::vector<double> t_;
  std::vector<Eigen::Vector3d> raw_base_;
  std::vector<Eigen::Vector3d> clean_base_;  ///< shorter: a spike is known some samples later
};

}  // namespace pcavr
