// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace pcavr {

/// Stamps [s], strictly ascending, and values of one signal. All functions here require finite
/// numbers (readers refuse others) and throw ContractError where lengths differ. Threads: pure
/// functions.

/// The mean time between two of at least two stamps [s].
[[nodiscard]] double mean_interval(std::span<const double> t);

/// One component, 0 to 2, of a vector signal.
[[nodiscard]] std::vector<double> axis_of(std::span<const Eigen::Vector3d> values, int axis);

struct SpikeOptions {
  int half_window = 3;      ///< samples on either side that the middle one is held against, >= 1
  double deviations = 5.0;  ///< from the median, in robust standard deviations
  /// The whole signal's, where the values are a part of it; else measured on the values.
  std::optional<double> noise = {};
};

struct DespikedSignal {
  std::vector<double> values;
  std::vector<std::size_t> spikes;  ///< indices that were replaced by the median around them
};

/// Takes out single wild samples [Hampel 1974; Pearson 2002]. The deviation is the window's, but no
/// less than the whole signal's noise, so that seven quiet neighbours do not condemn an honest one.
[[nodiscard]] DespikedSignal remove_spikes(std::span<const double> values,
                                           const SpikeOptions& options = {});

/// Standard deviation of the white noise on a signal, from its second differences: robust against
/// spikes, blind to motion slower than a few samples.
[[nodiscard]] double noise_deviation(std::span<const double> values);

struct SaturatedStretch {
  double begin = 0.0, end = 0.0;  ///< [s]
  double force = 0.0;             ///< [N] > 0: how far the axis reaches
};

/// Stretches in which an axis of a force stands still at its own extreme: the sensor's end.
[[nodiscard]] std::vector<SaturatedStretch> find_saturation(std::span<const double> t,
                                                            std::span<const Eigen::Vector3d> force);

/// A signal and its derivatives at one instant.
struct SmoothedSample {
  double value = 0.0;
  double rate = 0.0;          ///< [1/s]
  double acceleration = 0.0;  ///< [1/s^2]
  bool is_valid = false;      ///< false at the ends and in gaps, where the window is not full
};

/// Local polynomials over |t - at| < half_width, at the stamps as they are (jitter and different
/// clocks do no harm). After [Savitzky & Golay 1964], with one departure: an unweighted local
/// quadratic's second derivative is that of the signal smoothed by the kernel (1 - u^2)^2, but its
/// slope and value are those of other kernels, which costs per cents of mass at 2 Hz. Here the
/// slope comes from a fit weighted 1 - u^2 and the value from a local line weighted (1 - u^2)^2:
/// all three are then exactly the derivatives of ONE smoothed signal, and so fit any linear law
/// together with a force smoothed alike.
[[nodiscard]] SmoothedSample smooth_at(std::span<const double> t, std::span<const double> values,
                                       double at, double half_width);
[[nodiscard]] std::vector<SmoothedSample> smooth(std::span<const double> t,
                                                 std::span<const double> values,
                                                 std::span<const double> at, double half_width);

/// How many samples at `interval` seconds the smoothing makes into one independent sample.
[[nodiscard]] double correlated_samples(double half_width, double interval);

/// The same smoothing while samples come in, with a known delay: what it gives belongs to an
/// instant `delay()` ago and carries that instant's stamp. After the constructor nothing is
/// allocated.
class CausalFilter {
 public:
  struct Output {
    double t = 0.0;  ///< [s] the instant it speaks of
    double position = 0.0, speed = 0.0, acceleration = 0.0, force = 0.0;
  };

  /// half_width [s]; rate [1/s] of the samples; force_noise [N], the least deviation that spikes
  /// are judged by.
  CausalFilter(double half_width, double rate, double force_noise);

  /// A position and a force of the same instant t, later than the one before; otherwise, or where a
  /// number is not finite, the sample is left out. Empty until the window has filled.
  std::optional<Output> step(double t, double position, double force) noexcept;
  [[nodiscard]] double delay() const { return half_width_ + 2.0 * interval_; }

 private:
  double half_width_;
  double interval_;
  double force_noise_;
  std::vector<double> t_, position_, force_;  ///< oldest first
  std::size_t count_ = 0;
};

struct TimeOffset {
  double offset = 0.0;       ///< [s] b happens this much later than a: b(t + offset) ~ a(t)
  double deviation = 0.0;    ///< [s] standard deviation
  double correlation = 0.0;  ///< at the offset, -1 to 1; negative: one of them has the wrong sign
  bool is_known = false;     ///< false: too weak a correlation, or the best at the range's end
};

struct TimeOffsetOptions {
  double range = 0.25;           ///< [s] largest offset looked for
  double min_correlation = 0.5;  ///< below, nothing is said
};

/// How much later b happens than a, by normalised correlation on a common grid, then a parabola
/// about its peak. Give signals that share their changes: penetration and force, or the rates of
/// both. The deviation is that of the least-squares match, from its residual and a's slope.
[[nodiscard]] TimeOffset estimate_time_offset(std::span<const double> t_a,
                                              std::span<const double> a,
                                              std::span<const double> t_b,
                                              std::span<const double> b,
                                              const TimeOffsetOptions& options = {});

/// The slow drift of a force: the mean of contact-free samples within half_width [s] of each
/// instant, carried in a straight line across contacts. Zero where nothing is free.
[[nodiscard]] std::vector<Eigen::Vector3d> track_bias(std::span<const double> t,
                                                      std::span<const Eigen::Vector3d> force,
                                                      const std::vector<bool>& is_free,
                                                      double half_width = 0.25);

}  // namespace pcavr
