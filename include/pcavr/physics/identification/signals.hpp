// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// Timestamps [s], strictly ascending, and values of one signal. All functions here require finite
/// numbers (readers refuse others) and throw ContractError where lengths differ. Threads: pure
/// functions.

/// The mean time between two of at least two stamps [s].
[[nodiscard]] double mean_interval(std::span<const double> t);

/// One component, 0 to 2, of a vector signal.
[[nodiscard]] std::vector<double> axis_of(std::span<const Eigen::Vector3d> values, int axis);

/// Defaults and ranges of all options of this module: src/physics/identification/options.cpp.
struct SpikeOptions {
  SpikeOptions();
  int half_window;   ///< samples on either side that the middle one is compared with
  double threshold;  ///< distance from the median, in robust standard deviations
  /// Std of the whole signal's noise, where the values are a part of it; else estimated from them.
  std::optional<double> noise;
};
[[nodiscard]] OptionSection section_of(SpikeOptions& options);

struct DespikedSignal {
  std::vector<double> values;
  std::vector<std::size_t> spikes;  ///< indices that were replaced by the median around them
};

/// Hampel filter: replaces single outliers by the median [Hampel 1974; Pearson 2002]. The std is
/// the window's, but no less than the whole signal's noise, so that a valid sample among seven
/// nearly equal ones is not rejected.
[[nodiscard]] DespikedSignal remove_spikes(std::span<const double> values,
                                           const SpikeOptions& options = {});

/// Standard deviation of the white noise on a signal, from its second differences: robust against
/// spikes, insensitive to motion slower than a few samples.
[[nodiscard]] double estimate_noise_std(std::span<const double> values);

struct SaturationOptions {
  SaturationOptions();
  int min_samples;           ///< consecutive, at exactly the same extreme
  double min_extreme_ratio;  ///< of the extreme to the axis' noise
};
[[nodiscard]] OptionSection section_of(SaturationOptions& options);

struct SaturatedInterval {
  double begin = 0.0, end = 0.0;  ///< [s]
  double force = 0.0;             ///< [N] > 0: the measuring range of the axis
};

/// Intervals in which an axis of a force stays constant at its own extreme: sensor saturation
/// (clipping).
[[nodiscard]] std::vector<SaturatedInterval> find_saturation(std::span<const double> t,
                                                             std::span<const Eigen::Vector3d> force,
                                                             const SaturationOptions& options = {});

/// A signal and its derivatives at one instant.
struct SmoothedSample {
  double value = 0.0;
  double rate = 0.0;          ///< [1/s]
  double acceleration = 0.0;  ///< [1/s^2]
  bool is_valid = false;      ///< false at the ends and in gaps, where the window is not full
};

/// Local polynomials over |t - at| < half_width, at the given timestamps (jitter and different
/// clocks are allowed). After [Savitzky & Golay 1964], with one departure: an unweighted local
/// quadratic's second derivative is that of the signal smoothed by the kernel (1 - u^2)^2, but its
/// slope and value are those of other kernels, which costs a few per cent of mass at 2 Hz. Here the
/// slope comes from a fit weighted 1 - u^2 and the value from a local line weighted (1 - u^2)^2:
/// all three are then exactly the derivatives of ONE smoothed signal, and so satisfy any linear law
/// together with a force smoothed by the same kernel.
[[nodiscard]] SmoothedSample smooth_at(std::span<const double> t, std::span<const double> values,
                                       double at, double half_width);
[[nodiscard]] std::vector<SmoothedSample> smooth(std::span<const double> t,
                                                 std::span<const double> values,
                                                 std::span<const double> at, double half_width);

/// The number of samples, `interval` seconds apart, that the smoothing correlates: they count as
/// one independent sample.
[[nodiscard]] double correlated_samples(double half_width, double interval);

/// The same smoothing online, with a fixed latency: each output is for the instant `delay()` ago
/// and has that instant's timestamp. After the constructor nothing is allocated.
class CausalFilter {
 public:
  struct Output {
    double t = 0.0;  ///< [s] the instant it is valid for
    double position = 0.0, speed = 0.0, acceleration = 0.0, force = 0.0;
  };

  /// half_width [s]; rate [1/s] of the samples; force_noise [N], the minimum std that the spike
  /// threshold is based on. Of `spikes` the threshold is used.
  CausalFilter(double half_width, double rate, double force_noise, const SpikeOptions& spikes = {});

  /// A position and a force of the same instant t, later than the one before; otherwise, or where a
  /// number is not finite, the sample is ignored. Empty until the window is full.
  std::optional<Output> step(double t, double position, double force) noexcept;
  [[nodiscard]] double delay() const { return half_width_ + 2.0 * interval_; }

 private:
  double half_width_;
  double interval_;
  double force_noise_;
  double spike_threshold_;
  std::vector<double> t_, position_, force_;  ///< oldest first
  std::size_t count_ = 0;
};

struct TimeOffset {
  double offset = 0.0;       ///< [s] b happens this much later than a: b(t + offset) ~ a(t)
  double std = 0.0;          ///< [s] standard deviation
  double correlation = 0.0;  ///< at the offset, -1 to 1; negative: one of them has the wrong sign
  bool is_known = false;     ///< false: correlation too weak, or its maximum at the range's end
};

struct TimeOffsetOptions {
  TimeOffsetOptions();
  double range;                ///< [s] maximum offset searched
  double min_correlation;      ///< below, the offset is not known
  double smoothing_intervals;  ///< half width, in sampling intervals of the slower signal
};
[[nodiscard]] OptionSection section_of(TimeOffsetOptions& options);

/// The time by which b happens later than a, by normalised cross-correlation on a common grid, then
/// a parabola through its peak. It is for signals that change together: penetration and force, or
/// the rates of both. The std is that of the least-squares match, from its residual and a's slope.
[[nodiscard]] TimeOffset estimate_time_offset(std::span<const double> t_a,
                                              std::span<const double> a,
                                              std::span<const double> t_b,
                                              std::span<const double> b,
                                              const TimeOffsetOptions& options = {});

/// The slow drift of a force: the mean of contact-free samples within half_width [s] of each
/// instant, interpolated linearly across contacts. Zero where nothing is free of contact. See
/// SegmentationOptions::bias_half_width.
[[nodiscard]] std::vector<Eigen::Vector3d> track_bias(std::span<const double> t,
                                                      std::span<const Eigen::Vector3d> force,
                                                      const std::vector<bool>& is_free,
                                                      double half_width);

}  // namespace pcavr
