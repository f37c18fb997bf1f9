// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/calibration/clock_offset.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "clock_fit.hpp"
#include "clock_step.hpp"
#include "velocity_signal.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kMaxCoarse = 3000;  ///< samples of the search over all offsets
constexpr std::size_t kPeaks = 4;         ///< of the search, each of which is refined
constexpr double kMinDriftSpan = 30.0;    ///< [s]
/// Two offsets of which the second explains nearly as much are ambiguous.
constexpr double kMaxSecond = 0.9;

/// Norms of a signal on a grid; negative where it is not known.
std::vector<double> norms_on_grid(const VelocitySignal& signal, double step) {
  std::vector<double> norms;
  for (double t = signal.begin(); t <= signal.end(); t += step) {
    const auto value = signal.at(t);
    norms.push_back(value ? value->norm() : -1.0);
  }
  return norms;
}

/// Correlation of a[i + lag] with b[i]; 0 where too few are known.
double correlation_at(const std::vector<double>& a, const std::vector<double>& b,
                      std::ptrdiff_t lag, std::size_t min_count) {
  double n = 0.0, sum_a = 0.0, sum_b = 0.0, aa = 0.0, bb = 0.0, ab = 0.0;
  const auto size_a = static_cast<std::ptrdiff_t>(a.size());
  const auto size_b = static_cast<std::ptrdiff_t>(b.size());
  for (std::ptrdiff_t i = std::max<std::ptrdiff_t>(0, -lag); i < std::min(size_b, size_a - lag);
       ++i) {
    const double p = a[static_cast<std::size_t>(i + lag)], q = b[static_cast<std::size_t>(i)];
    if (p < 0.0 || q < 0.0) continue;
    n += 1.0, sum_a += p, sum_b += q, aa += p * p, bb += q * q, ab += p * q;
  }
  if (n < static_cast<double>(min_count)) return 0.0;
  const double var_a = aa - sum_a * sum_a / n, var_b = bb - sum_b * sum_b / n;
  if (!(var_a > 0.0) || !(var_b > 0.0)) return 0.0;
  return (ab - sum_a * sum_b / n) / std::sqrt(var_a * var_b);
}

/// The offsets with the highest correlations of the norms, which no turn changes: local maxima.
std::vector<double> candidate_offsets(const VelocitySignal& a, const VelocitySignal& b,
                                      double interval, double min_overlap) {
  const double span = std::max(a.end() - a.begin(), b.end() - b.begin());
  const double step = std::max(interval, span / static_cast<double>(kMaxCoarse));
  const std::vector<double> of_a = norms_on_grid(a, step), of_b = norms_on_grid(b, step);
  const auto known = [](const std::vector<double>& norms) {
    return std::count_if(norms.begin(), norms.end(), [](double norm) { return norm >= 0.0; });
  };
  const auto min_count = std::max<std::size_t>(
      kMinClockSamples / 2, static_cast<std::size_t>(min_overlap * static_cast<double>(std::min(
                                                                       known(of_a), known(of_b)))));
  const auto first = -static_cast<std::ptrdiff_t>(of_b.size());
  std::vector<double> correlations;
  for (std::ptrdiff_t lag = first; lag < static_cast<std::ptrdiff_t>(of_a.size()); ++lag) {
    correlations.push_back(correlation_at(of_a, of_b, lag, min_count));
  }
  std::vector<std::pair<double, double>> peaks;  // correlation, offset
  for (std::size_t i = 1; i + 1 < correlations.size(); ++i) {
    if (correlations[i] <= 0.0 || correlations[i] < correlations[i - 1] ||
        correlations[i] < correlations[i + 1]) {
      continue;
    }
    const auto lag = static_cast<double>(first + static_cast<std::ptrdiff_t>(i));
    peaks.emplace_back(correlations[i], a.begin() - b.begin() + lag * step);
  }
  std::sort(peaks.rbegin(), peaks.rend());
  std::vector<double> offsets;
  for (const auto& [correlation, offset] : peaks) {
    if (offsets.size() < kPeaks) offsets.push_back(offset);
  }
  return offsets;
}

/// The best of the candidates, and the second best that is another one.
struct RankedOffsets {
  ClockOffset best, second;
};

RankedOffsets rank_offsets(const VelocitySignal& a, const VelocitySamples& samples,
                           const std::vector<double>& candidates) {
  RankedOffsets ranked;
  for (const double offset : candidates) {
    ClockOffset found = ClockFit(a, samples).fit({.offset = offset});
    const bool is_new = std::abs(found.offset - ranked.best.offset) > a.half_window();
    if (found.explained > ranked.best.explained) {
      if (is_new) ranked.second = ranked.best;
      ranked.best = std::move(found);
    } else if (is_new && found.explained > ranked.second.explained) {
      ranked.second = std::move(found);
    }
  }
  return ranked;
}

/// The best of the candidates, or the reason why none can be chosen.
ClockOffset best_offset(const PoseStream& a, const PoseStream& b, Velocity kind,
                        const ClockOffsetOptions& options) {
  const double interval = std::max(a.interval(), b.interval());
  const double half_window = velocity_half_window(interval);
  const VelocitySignal of_a(a, kind, half_window, interval), of_b(b, kind, half_window, interval);
  const VelocitySamples samples = samples_of(of_b, std::min(a.interval(), b.interval()));
  if (samples.t.size() < kMinClockSamples) return {.reason = "too few samples"};
  auto [best, second] =
      rank_offsets(of_a, samples, candidate_offsets(of_a, of_b, interval, options.min_overlap));
  if (best.samples == 0) return best;
  const bool with_drift = options.is_drift_estimated && best.overlap > kMinDriftSpan;
  const ClockOffset drifting = ClockFit(of_a, samples).fit({.offset = best.offset, .drift = 0.0});
  if (auto stepping = find_clock_step(of_a, samples, drifting, with_drift)) return *stepping;
  if (best.is_observable && second.is_observable &&
      second.explained > kMaxSecond * best.explained) {
    best.is_observable = false;
    best.reason = fmt::format("the motion repeats: {:.3f} s and {:.3f} s fit alike", best.offset,
                              second.offset);
  }
  if (!best.is_observable) return best;
  return with_drift && drifting.is_observable ? drifting : best;
}

}  // namespace

ClockOffset estimate_clock_offset(const PoseStream& a, const PoseStream& b,
                                  const ClockOffsetOptions& options) {
  if (a.poses.size() < kMinClockSamples || b.poses.size() < kMinClockSamples) {
    return {.reason = fmt::format("one stream has less than {} poses", kMinClockSamples)};
  }
  ClockOffset rotation = best_offset(a, b, Velocity::angular, options);
  if (rotation.is_observable) return rotation;
  // Of a body that turns, the two frames' origins have different velocities.
  const ClockOffset shift = best_offset(a, b, Velocity::linear, options);
  if (shift.is_observable) return shift;
  if (rotation.reason.empty()) {
    rotation.reason = "the streams have no common motion that turns or speeds up";
  }
  return rotation;
}

std::vector<HandEyeView> paired_views(const PoseStream& a, const PoseStream& b,
                                      const ClockOffset& clock, std::size_t max_views) {
  const Duration max_gap = duration_from_seconds(max_interpolated_gap(a.interval()));
  std::vector<HandEyeView> views;
  for (const TimedPose& of_b : b.poses.poses()) {
    const auto of_a =
        a.poses.at(Stamp::from_seconds(clock.corrected(of_b.stamp.seconds())), max_gap);
    if (!of_a) continue;
    views.push_back({"t = " + format_stamp(of_b.stamp, 3), *of_a, of_b.pose});
  }
  if (views.size() <= max_views) return views;
  std::vector<HandEyeView> spread;
  for (std::size_t i = 0; i < max_views; ++i) {
    spread.push_back(std::move(views[i * views.size() / max_views]));
  }
  return spread;
}

}  // namespace pcavr
