// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "pcavr/core/median.hpp"
#include "pcavr/identification/breakaway.hpp"

namespace pcavr {
namespace {

/// A push that tells its limit this many times worse than the middle one was of another kind, as a
/// fast one among slow ones is: what biases it then is not in its deviation.
constexpr double kComparable = 3.0;

// Robust deviations, and share of the middle, beyond which a push is not one of the others.
constexpr double kFarOut = 5.0;
constexpr double kMinFarOut = 0.05;
constexpr std::size_t kOutliersFrom = 4;  ///< of fewer, nobody can say which one is wrong

using Indices = std::vector<std::size_t>;

Indices as_sure_as_most(std::span<const Breakaway> pushes, const Indices& found) {
  if (found.empty()) return {};
  std::vector<double> deviations;
  deviations.reserve(found.size());
  for (const std::size_t i : found) deviations.push_back(pushes[i].deviation);
  // The lower one of two in the middle: of a slow and a fast push, the slow one is believed.
  const auto middle = deviations.begin() + static_cast<std::ptrdiff_t>((deviations.size() - 1) / 2);
  std::nth_element(deviations.begin(), middle, deviations.end());
  Indices kept;
  for (const std::size_t i : found) {
    if (pushes[i].deviation <= kComparable * *middle) kept.push_back(i);
  }
  return kept;
}

Indices near_the_middle(std::span<const Breakaway> pushes, const Indices& found) {
  if (found.size() < kOutliersFrom) return found;
  std::vector<double> forces, off;
  forces.reserve(found.size());
  off.reserve(found.size());
  for (const std::size_t i : found) forces.push_back(pushes[i].force);
  const double middle = median(forces);
  for (const double force : forces) off.push_back(std::abs(force - middle));
  // 1.4826 makes a standard deviation of a median of distances.
  const double far = std::max(kFarOut * 1.4826 * median(off), kMinFarOut * middle);
  Indices kept;
  for (const std::size_t i : found) {
    if (std::abs(pushes[i].force - middle) <= far) kept.push_back(i);
  }
  return kept;
}

/// Weighted mean, and the spread about it that a sample of as many equal weights would have.
struct Weighted {
  double mean = 0.0;
  double deviation = 0.0;
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
  if (values.size() > 1 && n > 1.0) result.deviation = std::sqrt(spread / sum * n / (n - 1.0));
  return result;
}

std::vector<double> weights_of(const std::vector<double>& deviations, double scatter) {
  // A thousandth of the largest keeps a push that claims no error at all from being the only one.
  const double largest = *std::max_element(deviations.begin(), deviations.end());
  const double floor = largest > 0.0 ? 1e-6 * largest * largest : 1.0;
  std::vector<double> weights;
  weights.reserve(deviations.size());
  for (const double deviation : deviations) {
    weights.push_back(1.0 / (scatter * scatter + std::max(floor, deviation * deviation)));
  }
  return weights;
}

/// The scatter of the pushes themselves, beyond their measurement [Paule & Mandel 1982, random
/// effects]: where the weighted sum of squares is what chance makes it, n - 1. By bisection.
double scatter_between(const std::vector<double>& values, const std::vector<double>& deviations) {
  const auto excess = [&](double scatter) {
    const std::vector<double> weights = weights_of(deviations, scatter);
    const double mean = weigh(values, weights).mean;
    double sum = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      sum += weights[i] * std::pow(values[i] - mean, 2);
    }
    return sum - static_cast<double>(values.size() - 1);
  };
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  double low = 0.0;
  double high = *most - *least;
  if (high <= 0.0 || excess(low) <= 0.0) return 0.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (excess(middle) > 0.0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

LimitingFriction limiting_friction(std::span<const Breakaway> pushes) {
  LimitingFriction result;
  Indices found;
  for (std::size_t i = 0; i < pushes.size(); ++i) {
    if (pushes[i].is_found) found.push_back(i);
  }
  const Indices counted = near_the_middle(pushes, as_sure_as_most(pushes, found));
  std::set_difference(found.begin(), found.end(), counted.begin(), counted.end(),
                      std::back_inserter(result.left_out));
  result.missed = static_cast<int>(pushes.size() - found.size());
  result.pushes = static_cast<int>(counted.size());
  if (counted.empty()) return result;
  std::vector<double> forces, deviations, rates;
  for (const std::size_t i : counted) {
    forces.push_back(pushes[i].force);
    deviations.push_back(pushes[i].deviation);
    rates.push_back(pushes[i].loading_rate);
  }
  const std::vector<double> weights = weights_of(deviations, scatter_between(forces, deviations));
  const Weighted force = weigh(forces, weights);
  const Weighted rate = weigh(rates, weights);
  result.mean = force.mean;
  result.deviation = force.deviation;
  result.deviation_of_mean =
      forces.size() > 1 ? force.deviation / std::sqrt(force.effective_count) : deviations.front();
  result.loading_rate = rate.mean;
  result.loading_rate_deviation = rate.deviation;
  return result;
}

}  // namespace pcavr
