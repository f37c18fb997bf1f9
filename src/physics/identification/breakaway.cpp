// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/identification/breakaway.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "pcavr/base/core/check.hpp"
#include "pcavr/physics/identification/signals.hpp"
#include "pcavr/physics/identification/smoothed_values.hpp"

#include "physics/identification/peak.hpp"
#include "physics/identification/touch.hpp"

namespace pcavr {
namespace {

// The line needs some samples before it predicts anything.
constexpr int kMinLineSamples = 20;
// Consecutive samples in contact, or below the line, that confirm it (debouncing).
constexpr int kConsecutive = 3;
// Share of the line's rise below which a force counts as flat.
constexpr double kFlatShare = 0.05;

/// A straight line F = c0 + c1 d from running sums.
struct Line {
  double count = 0.0, d = 0.0, f = 0.0, dd = 0.0, df = 0.0;
  void add(double depth, double force) {
    count += 1.0, d += depth, f += force, dd += depth * depth, df += depth * force;
  }
  [[nodiscard]] double spread() const { return count * dd - d * d; }
  [[nodiscard]] double slope() const { return (count * df - d * f) / spread(); }
  [[nodiscard]] double at(double depth) const { return f / count + slope() * (depth - d / count); }
};

/// A push, smoothed, and its noise.
struct SmoothPush : TouchSignals {
  double half_width = 0.0;
  double interval = 0.0;
  double noise = 0.0;         ///< [N] of the raw force
  double smooth_noise = 0.0;  ///< [N] of the smoothed force
};

SmoothPush smooth_push(const ForceMotion& push, const BreakawayOptions& options) {
  SmoothPush result;
  result.t = push.t;
  result.interval = mean_interval(push.t);
  result.half_width = std::max(options.half_width, 3.0 * result.interval);
  result.force = remove_spikes(push.force).values;
  result.tool = smooth_values(push.t, push.tool, push.t, result.half_width);
  result.smooth_force = smooth_values(push.t, result.force, push.t, result.half_width);
  result.noise = estimate_noise_std(result.force);
  result.smooth_noise =
      result.noise / std::sqrt(correlated_samples(result.half_width, result.interval));
  return result;
}

std::size_t find_contact(const SmoothPush& push, double threshold) {
  int consecutive = 0;
  for (std::size_t i = 0; i < push.t.size(); ++i) {
    consecutive = push.smooth_force[i].is_valid && push.smooth_force[i].value > threshold
                      ? consecutive + 1
                      : 0;
    if (consecutive == kConsecutive) return i + 1 - kConsecutive;
  }
  return push.t.size();
}

std::size_t highest(const SmoothPush& push) {
  const auto at = std::max_element(push.smooth_force.begin(), push.smooth_force.end(),
                                   [](const auto& a, const auto& b) { return a.value < b.value; });
  return static_cast<std::size_t>(std::distance(push.smooth_force.begin(), at));
}

struct Alarm {
  std::size_t at = 0;
  Line line;
};

/// The first instant at which the force stays below the line fitted to the push until `guard` ago.
Alarm find_alarm(const SmoothPush& push, std::size_t contact, const BreakawayOptions& options) {
  Alarm alarm{push.t.size(), {}};
  Line line;
  int consecutive = 0;
  std::size_t oldest = contact;
  for (std::size_t i = contact; i < push.t.size() && push.smooth_force[i].is_valid; ++i) {
    for (; push.t[oldest] < push.t[i] - options.guard; ++oldest) {
      line.add(push.tool[oldest].value - push.tool[contact].value, push.smooth_force[oldest].value);
    }
    if (line.count < kMinLineSamples || line.spread() <= 0.0) continue;
    const double predicted = line.at(push.tool[i].value - push.tool[contact].value);
    const double shortfall = predicted - push.smooth_force[i].value;
    const bool is_below = shortfall > options.alarm_threshold * push.smooth_noise &&
                          shortfall > options.alarm_share * predicted;
    consecutive = is_below ? consecutive + 1 : 0;
    if (consecutive == kConsecutive) return {i, line};
  }
  alarm.line = line;
  return alarm;
}

struct Peak {
  std::size_t at = 0;
  std::size_t decided = 0;
  bool is_over = false;
};

/// Tracks the force from the alarm to the end of its rise.
Peak track_peak(const SmoothPush& push, std::size_t contact, const Alarm& alarm,
                const BreakawayOptions& options) {
  Peak peak{contact, alarm.at, false};
  for (std::size_t i = contact; i < push.t.size() && push.smooth_force[i].is_valid; ++i) {
    const double force = push.smooth_force[i].value;
    const double highest = push.smooth_force[peak.at].value;
    if (force > highest) peak.at = i;
    if (i < alarm.at) continue;
    peak.decided = i;
    const bool has_dropped = force < (1.0 - options.peak_drop) * highest - 2.0 * push.smooth_noise;
    std::size_t before = i;
    while (before > alarm.at && push.t[before] > push.t[i] - options.flat_time) --before;
    const double advance = push.tool[i].value - push.tool[before].value;
    const double expected = std::abs(alarm.line.slope()) * std::abs(advance);
    const bool is_flat = push.t[i] - push.t[before] >= options.flat_time &&
                         force - push.smooth_force[before].value < kFlatShare * expected;
    peak.is_over = has_dropped || is_flat;
    if (peak.is_over) return peak;
  }
  return peak;
}

}  // namespace

Breakaway find_breakaway(const ForceMotion& push, const BreakawayOptions& options) {
  PCAVR_REQUIRE(push.t.size() == push.tool.size() && push.t.size() == push.force.size());
  PCAVR_REQUIRE(options.half_width > 0.0 && options.guard > 0.0);
  Breakaway found;
  if (push.t.size() < std::size_t{2} * kMinLineSamples) {
    found.reason = "too few samples";
    return found;
  }
  const SmoothPush smooth = smooth_push(push, options);
  const std::size_t contact = find_contact(smooth, options.contact_threshold * smooth.smooth_noise);
  if (contact == push.t.size()) {
    found.reason = "no contact: the force stays within its noise";
    return found;
  }
  const auto touch_of = [&](std::size_t peak) { return touch_instant(smooth, 0, contact, peak); };
  const Alarm alarm = find_alarm(smooth, contact, options);
  if (alarm.at == push.t.size()) {
    found.t_contact = touch_of(std::max(contact, highest(smooth)));
    found.reason = "the force follows the line to the end: the object did not break loose";
    return found;
  }
  found.t_alarm = push.t[alarm.at];
  const Peak peak = track_peak(smooth, contact, alarm, options);
  found.is_found = peak.is_over;
  if (!peak.is_over) {
    found.t_contact = touch_of(std::max(contact, highest(smooth)));
    found.reason = "the force still rises at the end of the push";
    return found;
  }
  found.t_contact = touch_of(peak.at);
  found.t_decided = push.t[peak.decided] + smooth.half_width;
  const PeakSignals signals{smooth.t,     smooth.force,        smooth.smooth_force,
                            smooth.noise, smooth.smooth_noise, smooth.half_width};
  const ForcePeak fitted = fit_peak(signals, first_peak(signals, contact, peak.at));
  found.t = fitted.t;
  found.force = fitted.force;
  found.std = fitted.std;
  found.stiffness = alarm.line.slope();
  const double rise = found.t - push.t[contact];
  if (rise > 0.0) found.loading_rate = (found.force - smooth.smooth_force[contact].value) / rise;
  return found;
}

}  // namespace pcavr
