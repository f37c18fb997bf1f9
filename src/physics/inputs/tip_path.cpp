// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/inputs/tip_path.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "pcavr/base/core/check.hpp"
#include "pcavr/physics/identification/path_view.hpp"
#include "pcavr/physics/identification/signals.hpp"

#include "physics/inputs/tip_rules.hpp"

namespace pcavr {
namespace {

/// Samples that are searched for spikes at once.
constexpr std::size_t kChunk = 4096;

double noise_of(std::span<const Eigen::Vector3d> points) {
  double noise = 0.0;
  for (int axis = 0; axis < 3 && points.size() > 2; ++axis) {
    noise = std::max(noise, estimate_noise_std(axis_of(points, axis)));
  }
  return noise;
}

/// Marks single samples far from their neighbours. `interval` [s]: the mean one.
void mark_spikes(std::span<const Eigen::Vector3d> points, double noise, double interval,
                 std::vector<bool>& is_outlier) {
  const SpikeOptions options = tip_spike_options(noise);
  const auto overlap = static_cast<std::size_t>(options.half_window);
  for (std::size_t begin = 0; begin < points.size(); begin += kChunk) {
    const std::size_t end = std::min(begin + kChunk, points.size());
    const std::size_t first = begin - std::min(begin, overlap);
    const std::size_t count = std::min(end + overlap, points.size()) - first;
    for (int axis = 0; axis < 3; ++axis) {
      const std::vector<double> values = axis_of(points.subspan(first, count), axis);
      for (const std::size_t i : remove_spikes(values, options).spikes) {
        if (first + i < begin || first + i >= end) continue;
        const std::size_t from = i - std::min(i, overlap);
        const std::span<const double> around =
            std::span(values).subspan(from, std::min(i + overlap + 1, count) - from);
        if (!is_drivable(around, noise, interval)) is_outlier[first + i] = true;
      }
    }
  }
}

/// Marks excursions to a place that no arm can reach in that time. A tool that stays there for
/// longer than max_dropout is accepted.
void mark_dropouts(std::span<const double> t, std::span<const Eigen::Vector3d> points,
                   const InputOptions& options, std::vector<bool>& is_outlier) {
  std::optional<std::size_t> last;
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (is_outlier[i]) continue;
    if (last) is_outlier[i] = is_dropout(points[*last], points[i], t[i] - t[*last], options);
    if (!is_outlier[i]) last = i;
  }
}

/// Times at which the tip jumps farther between two samples than a tip can accelerate.
std::vector<double> find_jumps(std::span<const double> t, std::span<const Eigen::Vector3d> points,
                               double noise, const InputOptions& options) {
  std::vector<double> jumps;
  if (points.size() < 8) return jumps;
  const double interval = mean_interval(t);
  for (std::size_t i = 2; i + 2 < points.size(); ++i) {
    const std::span<const double, 5> near(&t[i - 2], 5);
    const std::span<const Eigen::Vector3d, 5> around(&points[i - 2], 5);
    if (!is_jump(near, around, noise, interval, options)) continue;
    const double dt = std::max(t[i] - t[i - 1], interval);
    if (jumps.empty() || !is_same_jump(jumps.back(), t[i], dt)) jumps.push_back(t[i]);
  }
  return jumps;
}

/// The intervals without samples where more than a few in a row were rejected.
void add_dropouts(std::span<const double> t, const std::vector<bool>& is_outlier, TipPath& path) {
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (!is_outlier[i]) continue;
    std::size_t end = i;
    while (end < t.size() && is_outlier[end]) ++end;
    if (end - i > kSingleSamples) path.bad.push_back({t[i], t[end - 1], {}});
    i = end;
  }
}

void keep(std::span<const double> t, std::span<const Eigen::Vector3d> points,
          const std::vector<bool>& is_outlier, TipPath& path) {
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (is_outlier[i]) {
      if (path.outliers++ == 0) path.first_outlier = t[i];
      continue;
    }
    path.kept_t.push_back(t[i]);
    path.kept_p_base.push_back(points[i]);
  }
  path.t = path.kept_t;
  path.p_base = path.kept_p_base;
}

}  // namespace

Eigen::Vector3d TipPath::at(double time) const { return PathView(t, p_base).at(time); }

TipPath clean_tip_path(std::span<const double> t, std::span<const Eigen::Vector3d> p_base,
                       const InputOptions& options) {
  PCAVR_REQUIRE(t.size() == p_base.size(), t.size(), p_base.size());
  TipPath path;
  path.t = t;
  path.p_base = p_base;
  if (t.size() < 3) return path;
  const auto calibrated = std::upper_bound(t.begin(), t.end(), t.front() + options.window);
  path.noise = noise_of(p_base.first(static_cast<std::size_t>(calibrated - t.begin())));
  std::vector<bool> is_outlier(t.size(), false);
  mark_spikes(p_base, path.noise, mean_interval(t), is_outlier);
  mark_dropouts(t, p_base, options, is_outlier);
  if (std::find(is_outlier.begin(), is_outlier.end(), true) != is_outlier.end()) {
    keep(t, p_base, is_outlier, path);
  }
  add_dropouts(t, is_outlier, path);
  path.jumps = find_jumps(path.t, path.p_base, path.noise, options);
  for (const double jump : path.jumps) path.bad.push_back({jump, jump, {}});
  std::sort(path.bad.begin(), path.bad.end(),
            [](const auto& a, const auto& b) { return a.begin < b.begin; });
  for (UnusableInterval& interval : path.bad) {
    interval.begin -= kBadMargin;
    interval.end += kBadMargin;
    interval.reason = kJumpReason;
  }
  return path;
}

}  // namespace pcavr
