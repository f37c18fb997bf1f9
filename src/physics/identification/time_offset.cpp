// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "pcavr/base/core/check.hpp"
#include "pcavr/physics/identification/signals.hpp"

namespace pcavr {
namespace {

/// Smoothed values on a uniform grid; not valid in gaps, of which nothing is known.
std::vector<SmoothedSample> resample(std::span<const double> t, std::span<const double> values,
                                     double start, double interval, std::size_t count,
                                     double half_width) {
  std::vector<double> grid(count);
  for (std::size_t k = 0; k < count; ++k) grid[k] = start + interval * static_cast<double>(k);
  return smooth(t, values, grid, half_width);
}

struct Match {
  double correlation = 0.0;
  double gain = 0.0;      ///< b ~ gain a + constant
  double residual = 0.0;  ///< variance of b about that
};

/// a[i] against b[i + lag], over the i where both are known; at least `min_pairs`.
Match match(const std::vector<SmoothedSample>& a, const std::vector<SmoothedSample>& b,
            std::ptrdiff_t lag, double min_pairs) {
  const auto count = static_cast<std::ptrdiff_t>(a.size());
  const std::ptrdiff_t begin = std::max<std::ptrdiff_t>(0, -lag);
  const std::ptrdiff_t end = std::min(count, count - lag);
  double sum_a = 0.0, sum_b = 0.0, aa = 0.0, bb = 0.0, ab = 0.0, n = 0.0;
  for (std::ptrdiff_t i = begin; i < end; ++i) {
    const SmoothedSample& of_a = a[static_cast<std::size_t>(i)];
    const SmoothedSample& of_b = b[static_cast<std::size_t>(i + lag)];
    if (!of_a.is_valid || !of_b.is_valid) continue;
    const double p = of_a.value, q = of_b.value;
    sum_a += p, sum_b += q, aa += p * p, bb += q * q, ab += p * q, n += 1.0;
  }
  if (n < min_pairs) return {};
  const double var_a = aa / n - sum_a * sum_a / (n * n);
  const double var_b = bb / n - sum_b * sum_b / (n * n);
  const double cov = ab / n - sum_a * sum_b / (n * n);
  if (var_a <= 0.0 || var_b <= 0.0) return {};
  return {cov / std::sqrt(var_a * var_b), cov / var_a, std::max(var_b - cov * cov / var_a, 0.0)};
}

double slope_energy(const std::vector<SmoothedSample>& a, double interval) {
  double sum = 0.0;
  for (std::size_t i = 1; i + 1 < a.size(); ++i) {
    if (!a[i - 1].is_valid || !a[i + 1].is_valid) continue;
    const double slope = (a[i + 1].value - a[i - 1].value) / (2.0 * interval);
    sum += slope * slope;
  }
  return sum;
}

}  // namespace

TimeOffset estimate_time_offset(std::span<const double> t_a, std::span<const double> a,
                                std::span<const double> t_b, std::span<const double> b,
                                const TimeOffsetOptions& options) {
  PCAVR_REQUIRE(t_a.size() == a.size() && t_b.size() == b.size());
  PCAVR_REQUIRE(options.range > 0.0, options.range);
  TimeOffset result;
  if (a.size() < 3 || b.size() < 3) return result;
  const double interval = std::min(mean_interval(t_a), mean_interval(t_b));
  // Both signals are smoothed alike, which shifts neither: white noise would roughen the
  // correlation's peak.
  const double half_width =
      options.smoothing_intervals * std::max(mean_interval(t_a), mean_interval(t_b));
  const double start = std::max(t_a.front(), t_b.front()) + half_width;
  const double end = std::min(t_a.back(), t_b.back()) - half_width;
  const auto lags = static_cast<std::ptrdiff_t>(std::ceil(options.range / interval));
  const double min_duration = 4.0 * options.range;
  if (end - start < min_duration) return result;
  const auto count = static_cast<std::size_t>((end - start) / interval) + 1;
  const std::vector<SmoothedSample> grid_a = resample(t_a, a, start, interval, count, half_width);
  const std::vector<SmoothedSample> grid_b = resample(t_b, b, start, interval, count, half_width);

  std::vector<Match> matches;
  for (std::ptrdiff_t lag = -lags; lag <= lags; ++lag)
    matches.push_back(match(grid_a, grid_b, lag, (min_duration - options.range) / interval));
  const auto best =
      std::max_element(matches.begin(), matches.end(), [](const auto& l, const auto& r) {
        return std::abs(l.correlation) < std::abs(r.correlation);
      });
  const std::ptrdiff_t lag = best - matches.begin() - lags;
  result.correlation = best->correlation;
  result.offset = static_cast<double>(lag) * interval;
  if (std::abs(lag) == lags) return result;
  const double left = std::abs(std::prev(best)->correlation);
  const double right = std::abs(std::next(best)->correlation);
  const double curvature = left - 2.0 * std::abs(best->correlation) + right;
  if (curvature < 0.0) result.offset += 0.5 * (left - right) / curvature * interval;
  const double slopes = best->gain * best->gain * slope_energy(grid_a, interval);
  const double correlated = correlated_samples(half_width, interval);
  if (slopes > 0.0) result.std = std::sqrt(best->residual * correlated / slopes);
  result.is_known = std::abs(result.correlation) >= options.min_correlation;
  return result;
}

}  // namespace pcavr
