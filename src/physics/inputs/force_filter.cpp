// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/inputs/force_filter.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <utility>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "pcavr/base/core/median.hpp"

#include "physics/inputs/free_noise.hpp"
#include "physics/inputs/stream_gaps.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kLags = 8;        // [samples] in which noise is white, or not
constexpr std::size_t kMaxOrder = 3;    // of a sensor's low pass
constexpr double kMinNeighbours = 0.5;  // correlation of neighbours behind a filter
constexpr double kMaxExcess = 0.1;      // of a correlation over one that falls by degrees
constexpr double kMinDelay = 0.25;      // [sample intervals] less is near the noise's own
/// A low pass passes nothing much larger than what is slow; a vibration does.
constexpr double kMaxGain = 1.5;
/// Of a delay's std over that of a low pass of first order, by simulated noise.
constexpr double kButterworthStd = 0.5;
constexpr double kMaxGivenCutoff =
    0.4;                         ///< [1/samples] of a Butterworth low pass with a given delay
constexpr int kCutoffSteps = 4;  ///< as its delay is nearly the inverse of its cutoff
constexpr int kSpikePasses = 3;  // to find them, as they add to the first fit

double sum_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

bool is_white(const FreeRuns& runs) {
  return std::ranges::all_of(
      correlations_of(runs, kLags),
      [limit = correlation_limit(runs)](double value) { return std::abs(value) < limit; });
}

/// Noise that is partly white, partly slow, falls at once; behind a low pass it falls by degrees.
bool falls_by_degrees(const std::vector<double>& correlations) {
  return correlations.size() > 1 &&
         correlations[1] < correlations[0] * correlations[0] + kMaxExcess;
}

/// The autoregression of all axes by least squares, without spikes; each axis weighs by its noise.
std::vector<double> autoregression(const std::vector<FreeRuns>& axes, std::size_t order) {
  std::vector<double> coefficients(order, 0.0);
  const auto n = static_cast<Eigen::Index>(order);
  for (int pass = 0; pass < kSpikePasses; ++pass) {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
    for (const FreeRuns& runs : axes) {
      const FreeRuns left = innovations(runs, coefficients);
      const double std = std_of(left);
      if (!(std > 0.0)) return {};
      for (std::size_t r = 0; r < runs.size(); ++r) {
        for (std::size_t i = order; i < runs[r].size(); ++i) {
          if (std::abs(left[r][i - order]) > kSpikeStds * std) continue;
          const Eigen::Map<const Eigen::VectorXd> before(&runs[r][i - order], n);
          normal += before * before.transpose() / (std * std);
          right += before * runs[r][i] / (std * std);
        }
      }
    }
    // The newest sample is the last of `before`, and has the first coefficient.
    const Eigen::VectorXd solution = normal.ldlt().solve(right).reverse();
    coefficients.assign(solution.begin(), solution.end());
  }
  return coefficients;
}

/// Whether it passes slow changes best, and delays them.
bool is_low_pass(const ForceFilter& filter, double interval) {
  if (!(filter.delay > kMinDelay * interval)) return false;
  const double gain_at_zero = 1.0 - sum_of(filter.coefficients);
  constexpr int kFrequencies = 32;  // up to half the sampling rate
  double max_gain = 0.0, gain = 0.0;
  for (int k = 1; k <= kFrequencies; ++k) {
    std::complex<double> inverse = 1.0;
    for (std::size_t i = 0; i < filter.coefficients.size(); ++i) {
      const double angle = -std::numbers::pi * k / kFrequencies * static_cast<double>(i + 1);
      inverse -= filter.coefficients[i] * std::polar(1.0, angle);
    }
    gain = gain_at_zero / std::abs(inverse);
    max_gain = std::max(max_gain, gain);
  }
  return max_gain < kMaxGain && gain < 1.0;
}

/// [s] As of the first order that delays as much: its coefficient a has (1 - a^2) / n [Mann & Wald
/// 1943], and the delay is a / (1 - a).
double delay_std(const std::vector<FreeRuns>& axes, double delay, double interval) {
  double samples = 0.0;
  for (const FreeRuns& runs : axes) samples += samples_of(runs);
  const double a = delay / (delay + interval);
  return interval * std::sqrt((1.0 - a * a) / samples) / ((1.0 - a) * (1.0 - a));
}

std::optional<ForceFilter> filter_of(const std::vector<FreeRuns>& axes, std::size_t order,
                                     double interval) {
  ForceFilter filter{autoregression(axes, order), 0.0, 0.0, interval};
  const double gain = 1.0 - sum_of(filter.coefficients);
  if (filter.coefficients.empty() || !(gain > 0.0)) return std::nullopt;
  for (std::size_t i = 0; i < order; ++i) {
    filter.delay += static_cast<double>(i + 1) * filter.coefficients[i] / gain * interval;
  }
  if (!is_low_pass(filter, interval)) return std::nullopt;
  filter.std = delay_std(axes, filter.delay, interval);
  return filter;
}

std::optional<ForceFilter> find_recursion(const std::vector<FreeRuns>& axes, double interval) {
  for (std::size_t order = 1; order <= kMaxOrder; ++order) {
    std::optional<ForceFilter> filter = filter_of(axes, order, interval);
    if (!filter) continue;
    const bool explains = std::ranges::all_of(axes, [&](const FreeRuns& runs) {
      return is_white(innovations(runs, filter->coefficients));
    });
    if (explains) return filter;
  }
  return std::nullopt;
}

ForceFilter average_of(std::size_t samples, double interval) {
  return {.delay = 0.5 * static_cast<double>(samples - 1) * interval,
          .interval = interval,
          .average = samples};
}

ForceFilter filter_of(const Butterworth& butterworth, double interval) {
  return {
      .delay = butterworth.delay() * interval, .interval = interval, .butterworth = butterworth};
}

/// By the first kind that leaves white noise.
std::optional<ForceFilter> explain(const std::vector<FreeRuns>& axes, double interval) {
  if (const auto average = find_moving_average(axes)) return average_of(*average, interval);
  if (auto recursion = find_recursion(axes, interval)) return recursion;
  const std::optional<Butterworth> butterworth = find_butterworth(axes);
  if (!butterworth) return std::nullopt;
  ForceFilter filter = filter_of(*butterworth, interval);
  if (!(filter.delay > kMinDelay * interval)) return std::nullopt;
  filter.std = kButterworthStd * delay_std(axes, filter.delay, interval);
  return filter;
}

/// The one of another cutoff that has this delay [s].
ForceFilter with_delay(ForceFilter filter, double delay) {
  for (int i = 0; i < kCutoffSteps; ++i) {
    Butterworth slower = *filter.butterworth;
    slower.cutoff = std::min(slower.cutoff * filter.delay / delay, kMaxGivenCutoff);
    filter = filter_of(slower, filter.interval);
  }
  return filter;
}

/// The force before a filter, of uninterrupted samples.
std::vector<Eigen::Vector3d> before(const ForceFilter& filter,
                                    std::span<const Eigen::Vector3d> force) {
  if (filter.average > 0) return before_average(filter.average, filter.interval, force);
  if (filter.butterworth) return before_butterworth(*filter.butterworth, force);
  return before_recursion(filter.coefficients, force);
}

}  // namespace

FilterFinding find_force_filter(std::span<const double> t, std::span<const Eigen::Vector3d> force,
                                const Segmentation& found) {
  if (found.bias_base.size() != t.size()) return {};
  std::vector<FreeRuns> noisy;
  bool is_correlated = true;
  for (FreeRuns& runs : free_runs(t, found, force)) {
    if (!is_noisy(runs)) continue;
    const std::vector<double> correlations = correlations_of(runs, kLags);
    if (is_white(runs) || !falls_by_degrees(correlations)) return {};
    is_correlated = is_correlated && correlations.front() > kMinNeighbours;
    noisy.push_back(std::move(runs));
  }
  if (noisy.empty()) return {};
  std::optional<ForceFilter> filter = explain(noisy, mean_interval(t));
  const bool is_unknown = !filter && is_correlated;
  return {std::move(filter), is_unknown};
}

std::optional<ForceFilter> filter_with_delay(const ForceFilter& filter, double delay, double std) {
  const std::size_t order = filter.coefficients.size();
  if (order > 2 || filter.average > 0 || !(delay > 0.0)) return std::nullopt;
  if (filter.butterworth) {
    ForceFilter delayed = with_delay(filter, delay);
    delayed.std = std;
    return delayed;
  }
  if (order == 1) {
    return ForceFilter{{delay / (delay + filter.interval)}, delay, std, filter.interval};
  }
  // The poles of one that is slower by the ratio of the delays.
  const double half = 0.5 * filter.coefficients[0];
  const std::complex<double> root = std::sqrt(std::complex(half * half + filter.coefficients[1]));
  const std::complex<double> poles[] = {half + root, half - root};
  if (poles[0].real() <= 0.0 || poles[1].real() <= 0.0) return std::nullopt;
  const std::complex<double> first = std::pow(poles[0], filter.delay / delay);
  const std::complex<double> second = std::pow(poles[1], filter.delay / delay);
  const std::complex<double> delayed = first / (1.0 - first) + second / (1.0 - second);
  return ForceFilter{{(first + second).real(), -(first * second).real()},
                     delayed.real() * filter.interval,
                     std,
                     filter.interval};
}

std::vector<Eigen::Vector3d> without_filter(const ForceFilter& filter, std::span<const double> t,
                                            std::span<const Eigen::Vector3d> force) {
  std::vector<Eigen::Vector3d> result;
  const std::vector<StreamGap> gaps = stream_gaps(t);
  auto gap = gaps.begin();
  std::size_t first = 0;
  for (std::size_t i = 1; i <= force.size(); ++i) {
    while (i < force.size() && gap != gaps.end() && gap->end <= t[i - 1]) ++gap;
    const bool is_end = i == force.size() || (gap != gaps.end() && gap->end <= t[i]);
    if (!is_end) continue;
    const std::vector<Eigen::Vector3d> part = before(filter, force.subspan(first, i - first));
    result.insert(result.end(), part.begin(), part.end());
    first = i;
  }
  return result;
}

std::string kind_of(const ForceFilter& filter) {
  if (filter.average > 0) return fmt::format("a moving average of {} samples", filter.average);
  if (!filter.butterworth) return "a low-pass filter";
  return fmt::format("a Butterworth low-pass filter of order {} at {:.3g} Hz",
                     filter.butterworth->order, filter.butterworth->cutoff / filter.interval);
}

}  // namespace pcavr
