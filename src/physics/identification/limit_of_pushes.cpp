// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/identification/limit_of_pushes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "pcavr/base/core/check.hpp"

namespace pcavr {
namespace {

constexpr int kScatterGrid = 25;
constexpr double kScatterReach = 3.0;  // in stds of the scatter's prior
constexpr int kExcessGrid = 100;
constexpr double kExcessReach = 4.0;  // in stds of the excess's prior

}  // namespace

LimitOfPushes combine_limits(std::span<const IdentifiedParameter> limits, double scatter_share,
                             double scatter_factor) {
  PCAVR_REQUIRE(scatter_share > 0.0 && scatter_factor > 1.0);
  LimitOfPushes result;
  double largest = 0.0;
  for (const IdentifiedParameter& one : limits) {
    if (one.is_excited) largest = std::max(largest, one.value);
  }
  if (!(largest > 0.0)) return result;
  double total = 0.0, mean = 0.0, squares = 0.0, scatter_mean = 0.0;
  std::array<double, kScatterGrid> logs{}, means{}, variances{}, scatters{};
  for (int g = 0; g < kScatterGrid; ++g) {
    const auto k = static_cast<std::size_t>(g);
    const double in_stds = kScatterReach * (2.0 * g / (kScatterGrid - 1) - 1.0);
    scatters[k] = scatter_share * largest * std::pow(scatter_factor, in_stds);
    double weight = 0.0, weighted = 0.0, log_determinant = 0.0, misfit = 0.0;
    for (const IdentifiedParameter& one : limits) {
      if (!one.is_excited) continue;
      const double variance = one.std * one.std + scatters[k] * scatters[k];
      weight += 1.0 / variance;
      weighted += one.value / variance;
      misfit += one.value * one.value / variance;
      log_determinant += std::log(variance);
    }
    means[k] = weighted / weight;
    variances[k] = 1.0 / weight;
    misfit -= weighted * weighted / weight;
    logs[k] = -0.5 * (misfit + log_determinant + std::log(weight) + in_stds * in_stds);
  }
  const double best = *std::max_element(logs.begin(), logs.end());
  for (std::size_t k = 0; k < logs.size(); ++k) {
    const double weight = std::exp(logs[k] - best);
    total += weight;
    mean += weight * means[k];
    squares += weight * (variances[k] + means[k] * means[k]);
    scatter_mean += weight * scatters[k];
  }
  mean /= total;
  result.limit = {mean, std::sqrt(std::max(0.0, squares / total - mean * mean)), true};
  result.scatter = scatter_mean / total;
  return result;
}

IdentifiedParameter limit_above_sliding(const IdentifiedParameter& limit,
                                        const IdentifiedParameter& coulomb) {
  const double square = limit.std * limit.std + coulomb.std * coulomb.std;
  const double bound = (coulomb.value - limit.value) / std::sqrt(square);
  if (!limit.is_excited || !coulomb.is_excited || !(square > 0.0)) return limit;
  if (bound > kLimitContradiction) return {limit.value, limit.std, false};
  const double density = std::exp(-0.5 * bound * bound) / std::sqrt(2.0 * std::numbers::pi);
  const double remaining = 0.5 * std::erfc(bound / std::numbers::sqrt2);
  const double shift = density / remaining;  // of the mean, in stds of the difference
  const double gain = limit.std * limit.std / std::sqrt(square);
  const double narrowing = gain * gain * shift * (shift - bound);
  return {limit.value + gain * shift, std::sqrt(limit.std * limit.std - narrowing), true};
}

IdentifiedParameter excess_hidden_by_turning(double excess, double coulomb, double turning,
                                             const BreakawayPriors& priors) {
  PCAVR_REQUIRE(turning >= 0.0 && priors.turning_onset > 0.0, turning, priors.turning_onset);
  const double hidden = std::min(1.0, turning / priors.turning_onset);
  if (!(excess > 0.0) || !(coulomb > 0.0) || !(hidden > 0.0)) return {};
  const double width = std::log(priors.excess_factor);
  // ln(e / excess), to where s or the prior ends.
  const double median = std::log(priors.excess * coulomb / excess);
  const double last = std::max(0.0, median) + kExcessReach * width;
  const double end = hidden < 1.0 ? std::min(last, -std::log1p(-hidden)) : last;
  double total = 0.0, sum = 0.0, squares = 0.0;
  for (int g = 0; g < kExcessGrid; ++g) {
    const double log_ratio = end * (g + 0.5) / kExcessGrid;
    // The density of `excess` for this e and uniform s is constant over e, which is 1 / e.
    const double in_stds = (log_ratio - median) / width;
    const double weight = std::exp(-0.5 * in_stds * in_stds - log_ratio);
    total += weight;
    sum += weight * std::expm1(log_ratio);
    squares += weight * std::pow(std::expm1(log_ratio), 2);
  }
  if (!(total > 0.0)) return {};
  const double mean = sum / total;
  return {excess * mean, excess * std::sqrt(std::max(0.0, squares / total - mean * mean)), true};
}

}  // namespace pcavr
