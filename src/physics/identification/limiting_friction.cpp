// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "pcavr/base/core/median.hpp"
#include "pcavr/physics/identification/breakaway.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kMinForOutliers = 4;  ///< of fewer, it is undecidable which one is wrong

using Indices = std::vector<std::size_t>;

/// A push of a much larger std is of another kind, such as a fast one among slow ones: its bias is
/// then not included in its std.
Indices reject_uncertain(std::span<const Breakaway> pushes, const Indices& found,
                         double max_std_ratio) {
  if (found.empty()) return {};
  std::vector<double> stds;
  stds.reserve(found.size());
  for (const std::size_t i : found) stds.push_back(pushes[i].std);
  // The lower of two medians: of a slow and a fast push, the slow one is used.
  const auto middle = stds.begin() + static_cast<std::ptrdiff_t>((stds.size() - 1) / 2);
  std::nth_element(stds.begin(), middle, stds.end());
  Indices kept;
  for (const std::size_t i : found) {
    if (pushes[i].std <= max_std_ratio * *middle) kept.push_back(i);
  }
  return kept;
}

Indices reject_outliers(std::span<const Breakaway> pushes, const Indices& found,
                        const LimitingFrictionOptions& options) {
  if (found.size() < kMinForOutliers) return found;
  std::vector<double> forces, distances;
  forces.reserve(found.size());
  distances.reserve(found.size());
  for (const std::size_t i : found) forces.push_back(pushes[i].force);
  const double middle = median(forces);
  for (const double force : forces) distances.push_back(std::abs(force - middle));
  const double max_distance = std::max(options.outlier_stds * kStdOverMad * median(distances),
                                       options.min_outlier_share * middle);
  Indices kept;
  for (const std::size_t i : found) {
    if (std::abs(pushes[i].force - middle) <= max_distance) kept.push_back(i);
  }
  return kept;
}

/// Weighted mean, and the std about it for the effective number of equal weights.
struct Weighted {
  double mean = 0.0;
  double std = 0.0;
  double effective_count = 0.0;
};

Weighted weigh(const std::vector<double>& values, const std::vector<double>& weights) {
  double sum = 0.0, sum_of_squares = 0.0, weighted = 0.0, spread = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    sum += weights[i];
    sum_of_squares += weights[i] * weights[i];
    weighted += weights[i] * values[i];
  }
  Weighted result{.mean = weighted / sum, .effective_count = sum * sum / sum_of_squares};
  for (std::size_t i = 0; i < values.size(); ++i) {
    spread += weights[i] * std::pow(values[i] - result.mean, 2);
  }
  const double n = result.effective_count;
  if (values.size() > 1 && n > 1.0) result.std = std::sqrt(spread / sum * n / (n - 1.0));
  return result;
}

std::vector<double> weights_of(const std::vector<double>& stds, double scatter) {
  // The floor is a thousandth of max_std: a push with a std of zero must not get all the weight.
  const double max_std = *std::max_element(stds.begin(), stds.end());
  const double floor = max_std > 0.0 ? 1e-6 * max_std * max_std : 1.0;
  std::vector<double> weights;
  weights.reserve(stds.size());
  for (const double push_std : stds) {
    weights.push_back(1.0 / (scatter * scatter + std::max(floor, push_std * push_std)));
  }
  return weights;
}

/// The scatter between the pushes, beyond their measurement noise [Paule & Mandel 1982, random
/// effects]: where the weighted sum of squares has its expected value, n - 1. By bisection.
double scatter_between(const std::vector<double>& values, const std::vector<double>& stds) {
  const auto excess = [&](double scatter) {
    const std::vector<double> weights = weights_of(stds, scatter);
    const double mean = weigh(values, weights).mean;
    double sum = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      sum += weights[i] * std::pow(values[i] - mean, 2);
    }
    return sum - static_cast<double>(values.size() - 1);
  };
  const auto [min, max] = std::minmax_element(values.begin(), values.end());
  double low = 0.0;
  double high = *max - *min;
  if (high <= 0.0 || excess(low) <= 0.0) return 0.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (excess(middle) > 0.0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

LimitingFriction limiting_friction(std::span<const Breakaway> pushes,
                                   const LimitingFrictionOptions& options) {
  LimitingFriction result;
  Indices found;
  for (std::size_t i = 0; i < pushes.size(); ++i) {
    if (pushes[i].is_found) found.push_back(i);
  }
  const Indices counted =
      reject_outliers(pushes, reject_uncertain(pushes, found, options.max_std_ratio), options);
  std::set_difference(found.begin(), found.end(), counted.begin(), counted.end(),
                      std::back_inserter(result.left_out));
  result.missed = static_cast<int>(pushes.size() - found.size());
  result.pushes = static_cast<int>(counted.size());
  if (counted.empty()) return result;
  std::vector<double> forces, stds, rates;
  for (const std::size_t i : counted) {
    forces.push_back(pushes[i].force);
    stds.push_back(pushes[i].std);
    rates.push_back(pushes[i].loading_rate);
  }
  const std::vector<double> weights = weights_of(stds, scatter_between(forces, stds));
  const Weighted force = weigh(forces, weights);
  const Weighted rate = weigh(rates, weights);
  result.mean = force.mean;
  result.std = force.std;
  result.std_of_mean =
      forces.size() > 1 ? force.std / std::sqrt(force.effective_count) : stds.front();
  result.loading_rate = rate.mean;
  result.loading_rate_std = rate.std;
  return result;
}

}  // namespace pcavr
