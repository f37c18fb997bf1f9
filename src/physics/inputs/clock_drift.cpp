// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "physics/inputs/clock_offsets.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kMinDelays = 3;
constexpr double kMinExplained = 2.0 / 3.0;  // share of the contacts that lie on the line
constexpr double kMaxRate = 0.05;            // [s/s] no clock is worse
constexpr double kOutlierStds = 3.0;  // a contact's delay that is farther off has other causes
/// A line has one parameter more than a constant: squares over their variance that it must explain.
constexpr double kDecisiveDrift = 9.0;  // 3 stds
constexpr double kMinRateStds = 4.0;
constexpr double kMinBiases = 2.0;  // by which the delay must change: bodies may differ by one
constexpr int kDriftRefits = 3;

double stds_from(const ClockDrift& line, const PressDelay& of) {
  return std::abs(of.delay - line.delay(of.t)) / of.std;
}

double robust_squares(const ClockDrift& line, std::span<const PressDelay> delays) {
  double sum = 0.0;
  for (const PressDelay& delay : delays) {
    sum += std::pow(std::min(stds_from(line, delay), kOutlierStds), 2);
  }
  return sum;
}

void keep_better(const ClockDrift& line, std::span<const PressDelay> delays, double& squares,
                 ClockDrift& best) {
  const double found = robust_squares(line, delays);
  if (found < squares) squares = found, best = line;
}

/// By least squares, of the delays near `line`. The stds are those of the scatter, if it is larger.
ClockDrift refit(const ClockDrift& line, std::span<const PressDelay> delays) {
  double weights = 0.0, mean_t = 0.0, mean = 0.0, count = 0.0;
  std::vector<PressDelay> near;
  for (const PressDelay& delay : delays) {
    if (stds_from(line, delay) > kOutlierStds) continue;
    near.push_back(delay);
    const double weight = 1.0 / (delay.std * delay.std);
    weights += weight, mean_t += weight * delay.t, mean += weight * delay.delay, count += 1.0;
  }
  mean_t /= weights, mean /= weights;
  double squares = 0.0, products = 0.0;
  for (const PressDelay& delay : near) {
    const double weight = 1.0 / (delay.std * delay.std);
    squares += weight * (delay.t - mean_t) * (delay.t - mean_t);
    products += weight * (delay.t - mean_t) * (delay.delay - mean);
  }
  if (!(squares > 0.0)) return line;
  ClockDrift fitted{mean_t, mean, products / squares, 0.0};
  const double scatter = robust_squares(fitted, near) / std::max(count - 2.0, 1.0);
  fitted.rate_std = std::sqrt(std::max(1.0, scatter) / squares);
  return fitted;
}

}  // namespace

std::optional<ClockDrift> find_drift(std::span<const PressDelay> delays) {
  if (delays.size() < kMinDelays) return std::nullopt;
  ClockDrift constant, line;
  double constant_squares = std::numeric_limits<double>::infinity(), squares = constant_squares;
  for (std::size_t i = 0; i < delays.size(); ++i) {
    const PressDelay& first = delays[i];
    keep_better({first.t, first.delay, 0.0, 0.0}, delays, constant_squares, constant);
    for (std::size_t k = i + 1; k < delays.size(); ++k) {
      const double rate = (delays[k].delay - first.delay) / (delays[k].t - first.t);
      if (std::abs(rate) > kMaxRate) continue;
      keep_better({first.t, first.delay, rate, 0.0}, delays, squares, line);
    }
  }
  if (!std::isfinite(squares)) return std::nullopt;
  for (int i = 0; i < kDriftRefits; ++i) line = refit(line, delays);
  const auto on_line = static_cast<double>(std::ranges::count_if(
      delays, [&](const PressDelay& delay) { return stds_from(line, delay) < kOutlierStds; }));
  const double needed =
      std::max(static_cast<double>(kMinDelays), kMinExplained * static_cast<double>(delays.size()));
  const bool is_decisive = constant_squares - robust_squares(line, delays) > kDecisiveDrift &&
                           std::abs(line.rate) > kMinRateStds * line.rate_std;
  const double change = line.rate * (delays.back().t - delays.front().t);
  const bool is_large = std::abs(change) > kMinBiases * delays.front().bias;
  if (!is_decisive || !is_large || on_line < needed) return std::nullopt;
  return line;
}

}  // namespace pcavr
