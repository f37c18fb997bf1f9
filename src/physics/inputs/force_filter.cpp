// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/inputs/force_filter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <utility>

#include <Eigen/Dense>

#include "pcavr/base/core/median.hpp"

#include "physics/inputs/stream_gaps.hpp"

namespace pcavr {
namespace {

constexpr double kAroundContact = 0.3;    // [s] not free: a contact's slow rise, a filter's decay
constexpr std::size_t kMinRun = 50;       // samples without contact in a row
constexpr std::size_t kMinSamples = 250;  // of an axis: correlations within 0.06
constexpr std::size_t kLags = 8;          // [samples] in which noise is white, or not
constexpr std::size_t kMaxOrder = 3;      // of a sensor's low pass
constexpr double kMaxRepeated = 0.3;      // share of equal neighbours: rounded, or held
constexpr double kMaxCorrelation = 0.1;   // of noise that counts as white
constexpr double kWhiteStds = 4.0;        // of a correlation, where there are few samples
constexpr double kMinDelay = 0.25;        // [sample intervals] less is near the noise's own
/// A low pass passes nothing much larger than what is slow; a vibration does.
constexpr double kMaxGain = 1.5;
constexpr double kSpikeStds = 4.0;  // beyond which an innovation is a spike
constexpr int kSpikePasses = 3;     // to find them, as they add to the first fit

/// [N] Uninterrupted series of one axis without contact.
using FreeRuns = std::vector<std::vector<double>>;

/// By axis.
std::array<FreeRuns, 3> free_runs(std::span<const double> t, const Segmentation& found,
                                  std::span<const Eigen::Vector3d> force) {
  std::array<FreeRuns, 3> runs;
  const double max_step = 2.5 * mean_interval(t);  // more is a row that is missing
  std::vector<Eigen::Vector3d> run;
  const auto end_run = [&] {
    for (std::size_t axis = 0; axis < 3 && run.size() >= kMinRun; ++axis) {
      runs[axis].push_back(axis_of(run, static_cast<int>(axis)));
    }
    run.clear();
  };
  auto next = found.contacts.begin();
  for (std::size_t i = 0; i < t.size(); ++i) {
    while (next != found.contacts.end() && t[i] > next->end + kAroundContact) ++next;
    const bool is_free = next == found.contacts.end() || t[i] < next->begin - kAroundContact;
    if (!is_free || (i > 0 && t[i] - t[i - 1] > max_step)) end_run();
    if (is_free) run.push_back(force[i] - found.bias_base[i]);
  }
  end_run();
  return runs;
}

double samples_of(const FreeRuns& runs) {
  double samples = 0.0;
  for (const std::vector<double>& run : runs) samples += static_cast<double>(run.size());
  return samples;
}

/// Whether values of the axis are noise: many, and not rounded or held.
bool is_noisy(const FreeRuns& runs) {
  double equal = 0.0;
  for (const std::vector<double>& run : runs) {
    for (std::size_t i = 1; i < run.size(); ++i) equal += run[i] == run[i - 1] ? 1.0 : 0.0;
  }
  const double samples = samples_of(runs);
  return samples >= static_cast<double>(kMinSamples) && equal < kMaxRepeated * samples;
}

double sum_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

/// What an autoregression does not predict: from the order's sample of each run on.
FreeRuns innovations(const FreeRuns& runs, const std::vector<double>& coefficients) {
  FreeRuns result;
  for (const std::vector<double>& run : runs) {
    std::vector<double>& left = result.emplace_back();
    for (std::size_t i = coefficients.size(); i < run.size(); ++i) {
      double value = run[i];
      for (std::size_t k = 0; k < coefficients.size(); ++k) {
        value -= coefficients[k] * run[i - 1 - k];
      }
      left.push_back(value);
    }
  }
  return result;
}

/// [N] Robust.
double std_of(const FreeRuns& runs) {
  std::vector<double> sizes;
  for (const std::vector<double>& run : runs) {
    for (const double value : run) sizes.push_back(std::abs(value));
  }
  return kStdOverMad * median(std::move(sizes));
}

/// At lags 1, 2, ... [samples], without spikes.
std::vector<double> correlations_of(const FreeRuns& runs) {
  const double limit = kSpikeStds * std_of(runs);
  std::vector<double> correlations;
  double variance = 0.0;
  for (std::size_t lag = 0; lag <= kLags; ++lag) {
    double sum = 0.0, count = 0.0;
    for (const std::vector<double>& run : runs) {
      for (std::size_t i = lag; i < run.size(); ++i) {
        if (std::abs(run[i]) > limit || std::abs(run[i - lag]) > limit) continue;
        sum += run[i] * run[i - lag], count += 1.0;
      }
    }
    if (lag == 0) variance = sum / std::max(count, 1.0);
    if (lag > 0 && variance > 0.0) correlations.push_back(sum / std::max(count, 1.0) / variance);
  }
  return correlations;
}

bool is_white(const FreeRuns& runs) {
  const double limit = std::max(kMaxCorrelation, kWhiteStds / std::sqrt(samples_of(runs)));
  return std::ranges::all_of(correlations_of(runs),
                             [limit](double value) { return std::abs(value) < limit; });
}

/// Noise that is partly white, partly slow, falls at once; behind a low pass it falls by degrees.
bool falls_by_degrees(const std::vector<double>& correlations) {
  return correlations.size() > 1 &&
         correlations[1] < correlations[0] * correlations[0] + kMaxCorrelation;
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

std::optional<ForceFilter> filter_of(const std::vector<FreeRuns>& axes, std::size_t order,
                                     double interval) {
  ForceFilter filter{autoregression(axes, order), 0.0, 0.0, interval};
  const double gain = 1.0 - sum_of(filter.coefficients);
  if (filter.coefficients.empty() || !(gain > 0.0)) return std::nullopt;
  for (std::size_t i = 0; i < order; ++i) {
    filter.delay += static_cast<double>(i + 1) * filter.coefficients[i] / gain * interval;
  }
  if (!is_low_pass(filter, interval)) return std::nullopt;
  // As of the first order that delays as much: its coefficient a has (1 - a^2) / n [Mann & Wald
  // 1943], and the delay is a / (1 - a).
  double samples = 0.0;
  for (const FreeRuns& runs : axes) samples += samples_of(runs);
  const double a = filter.delay / (filter.delay + interval);
  filter.std = interval * std::sqrt((1.0 - a * a) / samples) / ((1.0 - a) * (1.0 - a));
  return filter;
}

}  // namespace

std::optional<ForceFilter> find_force_filter(std::span<const double> t,
                                             std::span<const Eigen::Vector3d> force,
                                             const Segmentation& found) {
  if (t.size() < kMinSamples || found.bias_base.size() != t.size()) return std::nullopt;
  std::vector<FreeRuns> noisy;
  for (FreeRuns& runs : free_runs(t, found, force)) {
    if (!is_noisy(runs)) continue;
    if (is_white(runs) || !falls_by_degrees(correlations_of(runs))) return std::nullopt;
    noisy.push_back(std::move(runs));
  }
  for (std::size_t order = 1; !noisy.empty() && order <= kMaxOrder; ++order) {
    const std::optional<ForceFilter> filter = filter_of(noisy, order, mean_interval(t));
    if (!filter) continue;
    const bool explains = std::ranges::all_of(noisy, [&](const FreeRuns& runs) {
      return is_white(innovations(runs, filter->coefficients));
    });
    if (explains) return filter;
  }
  return std::nullopt;
}

std::optional<ForceFilter> filter_with_delay(const ForceFilter& filter, double delay, double std) {
  const std::size_t order = filter.coefficients.size();
  if (order > 2 || !(delay > 0.0)) return std::nullopt;
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
  std::vector<Eigen::Vector3d> before(force.begin(), force.end());
  const std::size_t order = filter.coefficients.size();
  const double scale = 1.0 / (1.0 - sum_of(filter.coefficients));
  const std::vector<StreamGap> gaps = stream_gaps(t);
  auto gap = gaps.begin();
  for (std::size_t i = order; i < force.size(); ++i) {
    while (gap != gaps.end() && gap->end <= t[i - order]) ++gap;
    if (gap != gaps.end() && gap->end <= t[i]) continue;
    Eigen::Vector3d value = force[i];
    for (std::size_t k = 0; k < order; ++k) value -= filter.coefficients[k] * force[i - 1 - k];
    before[i] = scale * value;
  }
  return before;
}

}  // namespace pcavr
