// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/inputs/force_filter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <fmt/core.h>

#include "pcavr/base/core/median.hpp"

namespace pcavr {
namespace {

/// [s] 5 Hz. Faster filters look like a delay, which is corrected.
constexpr double kMinTimeConstant = 0.03;
constexpr double kFallHalfWidth = 0.010;  // [s] of the force's smoothing, short beside that
/// Levels of the fall, as shares of the peak: an exponential passes both steps in the same time;
/// F = k d^n of a tip that retreats steadily the second one in 0.4 (n = 1) to 0.7 (n = 3) of it.
constexpr std::array<double, 3> kFallLevels{0.4, 0.16, 0.064};
constexpr double kMinFallRatio = 0.8;
constexpr double kMaxFallRatio = 1.25;
constexpr double kMinLevelStds = 4.0;  // of the force's noise, at the lowest level
constexpr std::size_t kMinFilteredFalls = 2;
constexpr double kMinFilteredShare = 2.0 / 3.0;  // of the contacts that fall far enough to show it
constexpr double kMaxFallScatter = 0.2;      // of the time constants [median deviation, relative]
constexpr double kMinFreeCorrelation = 0.3;  // after half a time constant: 0.6 behind such a filter
constexpr double kFreeAround = 0.5;          // [s] from contacts, for what follows them to fade
constexpr std::size_t kMinFreePairs = 200;

struct Fall {
  double time_constant = 0.0;  ///< [s]
  double step_ratio = 0.0;     ///< 1 for an exponential
};

/// The fall at the end of a contact; nothing where noise hides it.
std::optional<Fall> fall_of(const ContactEpisode& contact, double noise) {
  if (contact.impact || contact.t.empty()) return std::nullopt;
  const std::vector<SmoothedSample> f = smooth(contact.t, contact.force, contact.t, kFallHalfWidth);
  double peak = 0.0;
  for (const SmoothedSample& sample : f) {
    if (sample.is_valid) peak = std::max(peak, sample.value);
  }
  if (kFallLevels.back() * peak < kMinLevelStds * noise) return std::nullopt;
  std::array<double, kFallLevels.size()> passed{};
  for (std::size_t level = 0; level < kFallLevels.size(); ++level) {
    std::size_t i = f.size();
    while (i > 0 && !(f[i - 1].is_valid && f[i - 1].value >= kFallLevels[level] * peak)) --i;
    if (i == 0) return std::nullopt;
    passed[level] = contact.t[i - 1];
  }
  const double first = passed[1] - passed[0], second = passed[2] - passed[1];
  if (!(first > 0.0)) return std::nullopt;
  return Fall{(passed[2] - passed[0]) / std::log(kFallLevels[0] / kFallLevels[2]), second / first};
}

/// Correlation of the force without contact with itself `delay` later; nothing where there is too
/// little of it.
std::optional<double> free_correlation(const Segmentation& found, std::span<const double> t,
                                       double delay) {
  const double interval = mean_interval(t);
  const auto lag = static_cast<std::size_t>(std::llround(delay / interval));
  const auto is_free = [&](double at) {
    return std::none_of(found.contacts.begin(), found.contacts.end(), [&](const auto& contact) {
      return at > contact.begin - kFreeAround && at < contact.end + kFreeAround;
    });
  };
  double squares = 0.0, products = 0.0;
  std::size_t pairs = 0;
  for (std::size_t i = 0; i + lag < found.force_base.size(); ++i) {
    if (!is_free(t[i]) || !is_free(t[i + lag])) continue;
    const Eigen::Vector3d &a = found.force_base[i], &b = found.force_base[i + lag];
    squares += 0.5 * (a.squaredNorm() + b.squaredNorm());
    products += a.dot(b);
    ++pairs;
  }
  if (pairs < kMinFreePairs || !(squares > 0.0)) return std::nullopt;
  return products / squares;
}

}  // namespace

std::optional<InputFault> force_filter_fault(const Segmentation& found,
                                             std::span<const double> t_force) {
  std::vector<double> time_constants;
  std::size_t falls = 0;
  for (const ContactEpisode& contact : found.contacts) {
    const std::optional<Fall> fall = fall_of(contact, found.noise);
    if (!fall) continue;
    ++falls;
    if (fall->step_ratio < kMinFallRatio || fall->step_ratio > kMaxFallRatio) continue;
    time_constants.push_back(fall->time_constant);
  }
  if (time_constants.size() < kMinFilteredFalls ||
      static_cast<double>(time_constants.size()) < kMinFilteredShare * static_cast<double>(falls)) {
    return std::nullopt;
  }
  const double time_constant = median(time_constants);
  if (time_constant < kMinTimeConstant) return std::nullopt;
  std::vector<double> deviations;
  for (const double one : time_constants) deviations.push_back(std::abs(one / time_constant - 1.0));
  if (median(std::move(deviations)) > kMaxFallScatter) return std::nullopt;
  const std::optional<double> correlation = free_correlation(found, t_force, 0.5 * time_constant);
  if (!correlation || *correlation < kMinFreeCorrelation) return std::nullopt;
  return InputFault{
      InputFaultKind::force_unit,  // like another unit: the tool can be replayed without it
      {.message = fmt::format(
           "the force is behind a low pass of about {:.1f} Hz: after {} contacts it falls with a "
           "time constant of {:.0f} ms, and its noise is as slow (correlation {:.2f} after half of "
           "that): what changes faster is not in the data",
           1.0 / (2.0 * std::numbers::pi * time_constant), time_constants.size(),
           1e3 * time_constant, *correlation),
       .file = "wrench.csv",
       .hint = "set the sensor's filter to 20 Hz or more, and record again"}};
}

}  // namespace pcavr
