// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <vector>

#include "pcavr/identification/breakaway.hpp"

namespace pcavr {
namespace {

/// A push that tells its limit this many times worse than the middle one was of another kind, as a
/// fast one among slow ones is: what biases it then is not in its deviation.
constexpr double kComparable = 3.0;

/// What the pushes that can be compared told.
struct Limits {
  std::vector<double> forces, deviations, rates;
};

Limits comparable(std::span<const Breakaway> pushes) {
  std::vector<double> deviations;
  for (const Breakaway& push : pushes) {
    if (push.is_found) deviations.push_back(push.deviation);
  }
  if (deviations.empty()) return {};
  // The lower one of two in the middle: of a slow and a fast push, the slow one is believed.
  const auto middle = deviations.begin() + static_cast<std::ptrdiff_t>((deviations.size() - 1) / 2);
  std::nth_element(deviations.begin(), middle, deviations.end());
  const double largest = kComparable * *middle;
  Limits limits;
  for (const Breakaway& push : pushes) {
    if (!push.is_found || push.deviation > largest) continue;
    limits.forces.push_back(push.force);
    limits.deviations.push_back(push.deviation);
    limits.rates.push_back(push.loading_rate);
  }
  return limits;
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
  result.missed = static_cast<int>(std::count_if(
      pushes.begin(), pushes.end(), [](const Breakaway& push) { return !push.is_found; }));
  const auto& [forces, deviations, rates] = comparable(pushes);
  result.pushes = static_cast<int>(forces.size());
  result.left_out = static_cast<int>(pushes.size()) - result.missed - result.pushes;
  if (forces.empty()) return result;
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
